! What of include/fixpair.h a Fortran host needs to make initial conditions and measure their power spectrum, by iso_c_binding. The
! header is the manual; names are its own.
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
  integer(c_int32_t), parameter :: fixpair_window_ngp = 1, fixpair_window_cic = 2, fixpair_window_tsc = 3, fixpair_window_pcs = 4
  integer(c_int32_t), parameter :: fixpair_compensation_none = 0, fixpair_compensation_window = 16
  integer(c_int32_t), parameter :: fixpair_compensation_aliased = 32

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

  type, bind(c) :: fixpair_positions_f64
    type(c_ptr) :: x, y, z
    integer(c_size_t) :: stride, length
  end type

  ! edges: c_loc of the host's array of integers |n|^2, `edges_len` long.
  type, bind(c) :: fixpair_binning
    integer(c_size_t) :: struct_size
    type(c_ptr) :: edges
    integer(c_size_t) :: edges_len
    integer(c_int32_t) :: second, orders
    type(c_ptr) :: second_edges
    integer(c_size_t) :: second_edges_len
    real(c_double) :: axis(3)
  end type

  type, bind(c) :: fixpair_bin
    integer(c_int64_t) :: modes
    real(c_double) :: first, second
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

    integer(c_int32_t) function fixpair_deposit_scratch_f64(scratch, region, particles, window) bind(c)
      import
      type(fixpair_layout), intent(out) :: scratch
      type(fixpair_brick), intent(in) :: region
      integer(c_size_t), value :: particles
      integer(c_int32_t), value :: window
    end function

    integer(c_int32_t) function fixpair_deposit_f64(mesh, mesh_len, region, position, weights, weights_stride, box_size, window, &
                                                    shift, scratch, scratch_len, exec) bind(c)
      import
      real(c_double), intent(inout) :: mesh(*)
      integer(c_size_t), value :: mesh_len, weights_stride, scratch_len
      type(fixpair_brick), intent(in) :: region
      type(fixpair_positions_f64), intent(in) :: position
      real(c_double), intent(in), optional :: weights(*)
      real(c_double), value :: box_size, shift
      integer(c_int32_t), value :: window
      type(c_ptr), value :: scratch, exec
    end function

    integer(c_int32_t) function fixpair_edges_uniform(edges, edges_len, first, width) bind(c)
      import
      integer(c_int64_t), intent(out) :: edges(*)
      integer(c_size_t), value :: edges_len
      real(c_double), value :: first, width
    end function

    integer(c_int32_t) function fixpair_binning_init(binning, edges, edges_len) bind(c)
      import
      type(fixpair_binning), intent(out) :: binning
      type(c_ptr), value :: edges
      integer(c_size_t), value :: edges_len
    end function

    integer(c_int32_t) function fixpair_binning_lengths(bins, values, words, binning, spectra) bind(c)
      import
      integer(c_size_t), intent(out) :: bins, values, words
      type(fixpair_binning), intent(in) :: binning
      integer(c_size_t), value :: spectra
    end function

    integer(c_int32_t) function fixpair_binning_read(bins, bins_len, values, values_len, sums, sums_len, binning, spectra) bind(c)
      import
      type(fixpair_bin), intent(out) :: bins(*)
      real(c_double), intent(out) :: values(*)
      integer(c_int64_t), intent(in) :: sums(*)
      integer(c_size_t), value :: bins_len, values_len, sums_len, spectra
      type(fixpair_binning), intent(in) :: binning
    end function

    integer(c_int32_t) function fixpair_binning_normalise(values, values_len, bins, bins_len, orders, factor) bind(c)
      import
      real(c_double), intent(inout) :: values(*)
      type(fixpair_bin), intent(in) :: bins(*)
      integer(c_size_t), value :: values_len, bins_len
      integer(c_int32_t), value :: orders
      real(c_double), value :: factor
    end function

    integer(c_int32_t) function fixpair_power_sums_scratch(scratch, brick, binning, pairs_len) bind(c)
      import
      type(fixpair_layout), intent(out) :: scratch
      type(fixpair_brick), intent(in) :: brick
      type(fixpair_binning), intent(in) :: binning
      integer(c_size_t), value :: pairs_len
    end function

    ! fields: c_loc of each mesh. Their numbers in pairs begin with 0.
    integer(c_int32_t) function fixpair_power_sums_f64(sums, sums_len, fields, fields_len, len, pairs, pairs_len, compensation, &
                                                       brick, binning, scratch, scratch_len, exec) bind(c)
      import
      integer(c_int64_t), intent(inout) :: sums(*)
      type(c_ptr), intent(in) :: fields(*)
      integer(c_size_t), intent(in) :: pairs(*)
      integer(c_int32_t), intent(in), optional :: compensation(*)
      integer(c_size_t), value :: sums_len, fields_len, len, pairs_len, scratch_len
      type(fixpair_brick), intent(in) :: brick
      type(fixpair_binning), intent(in) :: binning
      type(c_ptr), value :: scratch, exec
    end function

    integer(c_int32_t) function fixpair_pair_average(average, original, inverted, len) bind(c)
      import
      real(c_double), intent(out) :: average(*)
      real(c_double), intent(in) :: original(*), inverted(*)
      integer(c_size_t), value :: len
    end function
  end interface

  abstract interface
    integer(c_int32_t) function fixpair_transform_f64(context, data) bind(c)
      import
      type(c_ptr), value :: context
      real(c_double), intent(inout) :: data(*)
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
    type(fixpair_binning) :: binning
    integer(c_int64_t), target :: edges(2)
    edges = [1, 4]
    call fixpair_try(fixpair_binning_init(binning, c_loc(edges), 2_c_size_t))
    fixpair_matches = fixpair_conditions_init(conditions, 0_c_int64_t) == fixpair_ok
    fixpair_matches = fixpair_matches .and. conditions%struct_size == c_sizeof(conditions) &
        .and. conditions%realisation%struct_size == c_sizeof(conditions%realisation) &
        .and. conditions%cosmology%struct_size == c_sizeof(conditions%cosmology) &
        .and. conditions%linear%struct_size == c_sizeof(conditions%linear) &
        .and. binning%struct_size == c_sizeof(binning)
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

  ! The same to be read.
  function fixpair_positions(x) result(positions)
    real(c_double), intent(in), contiguous, target :: x(:, :)
    type(fixpair_positions_f64) :: positions
    positions = fixpair_positions_f64(c_loc(x(1, 1)), c_loc(x(2, 1)), c_loc(x(3, 1)), 3, size(x, 2, c_size_t))
  end function

  ! Cells to modes, not normalised, in place.
  subroutine fixpair_forward(fft, mesh)
    type(fixpair_fft_f64), intent(in) :: fft
    real(c_double), intent(inout), contiguous :: mesh(:)
    procedure(fixpair_transform_f64), pointer :: forward
    call c_f_procpointer(fft%forward, forward)
    if (forward(fft%context, mesh) /= 0) error stop "fixpair: the transform failed"
  end subroutine

  ! Memory that a ..._scratch function asked for; give it to fixpair_free.
  function fixpair_take(layout) result(memory)
    type(fixpair_layout), intent(in) :: layout
    type(c_ptr) :: memory
    memory = fixpair_aligned_alloc(layout%align, layout%size)
    if (.not. c_associated(memory)) error stop "fixpair: no memory left"
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
    transform%tables = fixpair_take(tables)
    transform%scratch = fixpair_take(scratch)
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
