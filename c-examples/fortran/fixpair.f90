! What of include/fixpair.h a Fortran host needs to make initial conditions, by iso_c_binding. The header is the manual; names are
! its own.
!
! Structs that may grow begin with struct_size, which their _init fills in: a library with other members refuses this module's
! (FIXPAIR_ERROR_VERSION), and fixpair_matches says so beforehand. Pointers are type(c_ptr): c_loc of an array that has target, or
! c_null_ptr.
module fixpair
  use, intrinsic :: iso_c_binding
  implicit none
  public

  integer(c_int32_t), parameter :: fixpair_ok = 0
  integer(c_int32_t), parameter :: fixpair_scheme_native = 0, fixpair_scheme_ngenic = 1, fixpair_scheme_fastpm = 2
  integer(c_int32_t), parameter :: fixpair_selection_cube = 0, fixpair_selection_sphere = 1
  integer(c_int32_t), parameter :: fixpair_amplitude_normal = 0, fixpair_amplitude_fixed = 1
  integer(c_int32_t), parameter :: fixpair_phase_original = 0, fixpair_phase_inverted = 1
  integer(c_int32_t), parameter :: fixpair_convention_cmb = 0, fixpair_convention_lss = 1
  integer(c_int32_t), parameter :: fixpair_shape_local = 0, fixpair_shape_equilateral = 1, fixpair_shape_orthogonal = 2
  integer(c_int32_t), parameter :: fixpair_shape_orthogonal_lss = 3, fixpair_shape_folded = 4
  integer(c_int32_t), parameter :: fixpair_linear_power = 0, fixpair_linear_transfer = 1
  integer(c_int32_t), parameter :: fixpair_linear_eisenstein_hu = 2, fixpair_linear_eisenstein_hu_smooth = 3
  integer(c_int32_t), parameter :: fixpair_normalise_as_given = 0, fixpair_normalise_sigma8 = 1
  integer(c_int32_t), parameter :: fixpair_order_first = 1, fixpair_order_second = 2, fixpair_order_third = 3

  type, bind(c) :: fixpair_layout
    integer(c_size_t) :: size, align
  end type

  type, bind(c) :: fixpair_brick
    integer(c_size_t) :: n
    integer(c_int32_t) :: space
    integer(c_size_t) :: start(3), count(3), stride(3)
  end type

  ! Filled by fixpair_fft_init_f64, or by the host with its own transform.
  type, bind(c) :: fixpair_fft_f64
    integer(c_size_t) :: struct_size
    type(c_ptr) :: context
    type(c_funptr) :: forward, inverse, sum
    type(fixpair_brick) :: configuration, fourier
    integer(c_size_t) :: length
  end type

  type, bind(c) :: fixpair_realisation
    integer(c_size_t) :: struct_size
    integer(c_int64_t) :: seed
    integer(c_int32_t) :: scheme, amplitude, phase, nyquist, selection, sample
  end type

  type, bind(c) :: fixpair_cosmology
    integer(c_size_t) :: struct_size
    real(c_double) :: omega_m, omega_de, omega_r, omega_b, h, n_s, w0, wa, t_cmb
  end type

  ! k and values: c_loc of the host's arrays, `rows` long.
  type, bind(c) :: fixpair_linear
    integer(c_size_t) :: struct_size
    integer(c_int32_t) :: source, normalisation
    type(c_ptr) :: k, value
    integer(c_size_t) :: rows
    real(c_double) :: amount
  end type

  type, bind(c) :: fixpair_conditions
    integer(c_size_t) :: struct_size
    type(fixpair_realisation) :: realisation
    type(fixpair_cosmology) :: cosmology
    type(fixpair_linear) :: linear
    real(c_double) :: redshift, box_size, f_nl, g_nl
    integer(c_int32_t) :: convention, order, shape
    integer(c_size_t) :: rows_len
    type(c_ptr) :: rows, species
  end type

  type, bind(c) :: fixpair_components_f64
    type(c_ptr) :: x, y, z
    integer(c_size_t) :: stride, length
  end type

  ! The built-in transform with the memory that it lives in. The library keeps addresses in it: let it stay where it is.
  type :: fixpair_transform
    type(fixpair_fft_f64) :: hook
    type(c_ptr) :: tables = c_null_ptr, scratch = c_null_ptr
  end type

  interface
    integer(c_int32_t) function fixpair_conditions_init(conditions, seed) bind(c)
      import
      type(fixpair_conditions), intent(out) :: conditions
      integer(c_int64_t), value :: seed
    end function

    integer(c_int32_t) function fixpair_initial_conditions_scratch_f64(scratch, conditions, fft, fine) bind(c)
      import
      type(fixpair_layout), intent(out) :: scratch
      type(fixpair_conditions), intent(in) :: conditions
      type(fixpair_fft_f64), intent(in) :: fft
      type(fixpair_fft_f64), intent(in), optional :: fine
    end function

    integer(c_int32_t) function fixpair_initial_conditions_f64(position, velocity, conditions, fft, fine, scratch, &
                                                               scratch_len, exec) bind(c)
      import
      type(fixpair_components_f64), intent(in) :: position, velocity
      type(fixpair_conditions), intent(in) :: conditions
      type(fixpair_fft_f64), intent(in) :: fft
      type(fixpair_fft_f64), intent(in), optional :: fine
      type(c_ptr), value :: scratch
      integer(c_size_t), value :: scratch_len
      type(c_ptr), value :: exec
    end function

    function fixpair_status_message(status) bind(c)
      import
      integer(c_int32_t), value :: status
      type(c_ptr) :: fixpair_status_message
    end function

    integer(c_int32_t) function fixpair_fft_tables_scratch_f64(size, n) bind(c)
      import
      type(fixpair_layout), intent(out) :: size
      integer(c_size_t), value :: n
    end function

    integer(c_int32_t) function fixpair_fft_tables_init_f64(tables, tables_len, n) bind(c)
      import
      type(c_ptr), value :: tables
      integer(c_size_t), value :: tables_len, n
    end function

    integer(c_int32_t) function fixpair_fft_scratch_f64(size, n) bind(c)
      import
      type(fixpair_layout), intent(out) :: size
      integer(c_size_t), value :: n
    end function

    integer(c_size_t) function fixpair_fft_padding_f64(n) bind(c)
      import
      integer(c_size_t), value :: n
    end function

    integer(c_int32_t) function fixpair_fft_init_f64(fft, tables, tables_len, padding, scratch, scratch_len, exec) bind(c)
      import
      type(fixpair_fft_f64), intent(out) :: fft
      type(c_ptr), value :: tables, scratch, exec
      integer(c_size_t), value :: tables_len, padding, scratch_len
    end function
  end interface

  ! The system's, for memory aligned to 64 bytes.
  interface
    type(c_ptr) function fixpair_aligned_alloc(alignment, size) bind(c, name="aligned_alloc")
      import
      integer(c_size_t), value :: alignment, size
    end function

    subroutine fixpair_free(memory) bind(c, name="free")
      import
      type(c_ptr), value :: memory
    end subroutine
  end interface

contains

  ! Has the library that is linked the structs of this module?
  logical function fixpair_matches()
    type(fixpair_conditions) :: conditions
    fixpair_matches = fixpair_conditions_init(conditions, 0_c_int64_t) == fixpair_ok
    fixpair_matches = fixpair_matches .and. conditions%struct_size == c_sizeof(conditions) &
        .and. conditions%realisation%struct_size == c_sizeof(conditions%realisation) &
        .and. conditions%cosmology%struct_size == c_sizeof(conditions%cosmology) &
        .and. conditions%linear%struct_size == c_sizeof(conditions%linear)
  end function

  ! Stops with the library's sentence about a status that is not 0.
  subroutine fixpair_try(status)
    integer(c_int32_t), intent(in) :: status
    character(kind=c_char), pointer :: letters(:)
    integer :: i
    if (status == fixpair_ok) return
    call c_f_pointer(fixpair_status_message(status), letters, [256])
    do i = 1, 256
      if (letters(i) == c_null_char) exit
      write (*, "(a)", advance="no") letters(i)
    end do
    write (*, *)
    error stop "fixpair"
  end subroutine

  ! Triples, x(:, particle), as the library takes them.
  function fixpair_triples(x) result(components)
    real(c_double), intent(in), contiguous, target :: x(:, :)
    type(fixpair_components_f64) :: components
    components = fixpair_components_f64(c_loc(x(1, 1)), c_loc(x(2, 1)), c_loc(x(3, 1)), 3, size(x, 2, c_size_t))
  end function

  ! A built-in transform of side n, on the calling thread.
  subroutine fixpair_transform_open(transform, n)
    type(fixpair_transform), intent(out) :: transform
    integer, intent(in) :: n
    type(fixpair_layout) :: tables, scratch
    integer(c_size_t) :: side
    side = n
    call fixpair_try(fixpair_fft_tables_scratch_f64(tables, side))
    call fixpair_try(fixpair_fft_scratch_f64(scratch, side))
    transform%tables = fixpair_aligned_alloc(tables%align, tables%size)
    transform%scratch = fixpair_aligned_alloc(scratch%align, scratch%size)
    call fixpair_try(fixpair_fft_tables_init_f64(transform%tables, tables%size, side))
    call fixpair_try(fixpair_fft_init_f64(transform%hook, transform%tables, tables%size, fixpair_fft_padding_f64(side), &
                                          transform%scratch, scratch%size, c_null_ptr))
  end subroutine

  subroutine fixpair_transform_close(transform)
    type(fixpair_transform), intent(inout) :: transform
    call fixpair_free(transform%tables)
    call fixpair_free(transform%scratch)
    transform%tables = c_null_ptr
    transform%scratch = c_null_ptr
  end subroutine

end module fixpair
