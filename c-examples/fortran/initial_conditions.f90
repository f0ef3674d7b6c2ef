! A Fixed pair of initial conditions, and one with f_NL, from Fortran in the host's own arrays x(3, particles) and v(3, particles),
! and what must hold of them.
program initial_conditions
  use fixpair
  implicit none
  integer, parameter :: n = 32
  real(c_double), parameter :: box = 500, redshift = 49
  real(c_double), allocatable, target :: x(:, :), v(:, :), x2(:, :), v2(:, :)
  integer :: failures = 0

  call claim(fixpair_matches(), "the structs of the module are those of the library")
  if (failures > 0) error stop 1
  call check_defaults()
  allocate (x(3, n**3), v(3, n**3), x2(3, n**3), v2(3, n**3))
  call make_particles(x, v, fixpair_phase_original, 0.0_c_double, fixpair_order_first)
  call make_particles(x2, v2, fixpair_phase_inverted, 0.0_c_double, fixpair_order_first)
  call claim(minval(x) >= 0 .and. maxval(x) < box, "positions are in [0, L)")
  call claim(maxval(abs(v)) > 1, "particles move")
  call claim(.not. any(abs(v + v2) > 0), "first order: the pair's velocities are opposite, bit for bit")
  call make_particles(x2, v2, fixpair_phase_original, 100.0_c_double, fixpair_order_second)
  ! f_NL Phi is 1e-3, second order some 1e-2.
  call claim(any(abs(v - v2) > 0) .and. maxval(abs(v - v2)) < 0.2 * maxval(abs(v)), "f_NL = 100 and second order change little")
  if (failures > 0) error stop 1

contains

  subroutine make_particles(x, v, phase, f_nl, order)
    real(c_double), intent(inout), contiguous, target :: x(:, :), v(:, :)
    integer(c_int32_t), intent(in) :: phase, order
    real(c_double), intent(in) :: f_nl
    type(fixpair_conditions) :: c
    type(fixpair_transform) :: fft
    type(fixpair_layout) :: layout
    type(c_ptr) :: scratch

    call fixpair_try(fixpair_conditions_init(c, 123456_c_int64_t))   ! the seed
    c%realisation%scheme = fixpair_scheme_ngenic                     ! the modes of 2LPTic and N-GenIC
    c%realisation%amplitude = fixpair_amplitude_fixed
    c%realisation%phase = phase                                      ! the two of a pair
    c%redshift = redshift
    c%box_size = box                                                 ! Mpc/h
    c%f_nl = f_nl
    c%order = order                                                  ! c%linear: c_loc of your k and P(k)
    call fixpair_transform_open(fft, n)
    call fixpair_try(fixpair_initial_conditions_scratch_f64(layout, c, fft%hook))
    scratch = fixpair_aligned_alloc(layout%align, layout%size)
    call fixpair_try(fixpair_initial_conditions_f64(fixpair_triples(x), fixpair_triples(v), c, fft%hook, scratch=scratch, &
                                                    scratch_len=layout%size, exec=c_null_ptr))
    call fixpair_free(scratch)
    call fixpair_transform_close(fft)
  end subroutine

  ! Every member has its default where this module has it.
  subroutine check_defaults()
    type(fixpair_conditions) :: c
    call fixpair_try(fixpair_conditions_init(c, 7_c_int64_t))
    call claim(c%realisation%seed == 7 .and. c%realisation%sample == 0 .and. abs(c%cosmology%omega_m - 0.27d0) < 1d-15 .and. &
               c%linear%source == fixpair_linear_eisenstein_hu .and. abs(c%linear%amount - 0.8d0) < 1d-15 .and. &
               nint(c%redshift) == 32 .and. nint(c%box_size) == 1000 .and. c%order == fixpair_order_second .and. &
               c%shape == fixpair_shape_local .and. .not. (c_associated(c%rows) .or. c_associated(c%species)), &
               "defaults are where the module looks for them")
  end subroutine

  subroutine claim(holds, what)
    logical, intent(in) :: holds
    character(*), intent(in) :: what
    write (*, "(4a)") "  ", merge("holds  ", "FAILS  ", holds), what
    if (.not. holds) failures = failures + 1
  end subroutine

end program initial_conditions
