!> Viscoplastic slip of cubic crystals: Meric and Cailletaud's law on twelve octahedral and six cubic systems.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! System i of plane normal n and direction l has the orientation tensor m = (l n + n l)/2 and the resolved stress m : s. With g its
!! slip in the increment dt (signed), v its accumulated slip, and values 0 at the start of the increment,
!!
!!     slip           |m : s + x| - r = K (|g|/dt)^(1/n),   the sign of g that of m : s + x;   no slip while the left is negative
!!     limit          r_i = r0 + sum over j of h_ij R_j,       R = (R_0 + b Q |g|)/(1 + b |g|)
!!     back stress    x = (x_0 - c f g)/(1 + d |g|),           f = phi + (1 - phi) exp(-delta v)
!!     stress         s = C : (e - sum of g m),                e the elastic trial strain
!!
!! h is 1 of a system with itself, -0.1 with others of its family, 0 between the families, as in CalculiX. These are backward Euler
!! differences. The unknowns are y with K y = m : s + x less the limit, g = dt sign(y) |y|^n: Newton's method with halved steps,
!! from the smaller of the slip without elastic relaxation and the slip that relaxes all stress. The tangent is that of the
!! differences; it is unsymmetric where systems harden each other.
!! References: L. Meric, P. Poubanne, G. Cailletaud, J. Engrg. Mat. Techn. 113 (1991) 162-170; G. Dhondt, CalculiX CrunchiX
!! USER'S MANUAL (names, constants, state variables).
module amontons_crystal_plasticity
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_logarithmic_strain, only: voigt_transformation
  use amontons_materials, only: INELASTIC_CRYSTAL
  use amontons_plasticity, only: RETURN_OK, RETURN_FAILED
  implicit none
  private
  public :: crystal_return_type, map_crystal_return, expand_creep_constants, N_SYSTEMS, N_CRYSTAL_STATE, N_CRYSTAL_CREEP_STATE, &
    N_CRYSTAL_CONSTANTS, STATE_ORDER

  integer, parameter :: N_SYSTEMS = 18             !< 12 octahedral, then 6 cubic
  integer, parameter :: N_OCTAHEDRAL = 12
  integer, parameter :: N_CRYSTAL_CONSTANTS = 9    !< of a family: K, n, c, d, phi, delta, r0, Q, b
  integer, parameter :: N_CRYSTAL_STATE = 60       !< plastic strain 11 22 33 12 13 23, then -R, x and v of the systems
  integer, parameter :: N_CRYSTAL_CREEP_STATE = 24 !< plastic strain, then v of the systems
  integer, parameter :: STATE_ORDER(6) = [1, 2, 3, 4, 6, 5]   !< 11 22 33 12 13 23 in xx yy zz xy yz xz

  integer, parameter :: NORMALS(3, N_SYSTEMS) = reshape([1, 1, 1, 1, 1, 1, 1, 1, 1, 1, -1, 1, 1, -1, 1, 1, -1, 1, &
    1, -1, -1, 1, -1, -1, 1, -1, -1, 1, 1, -1, 1, 1, -1, 1, 1, -1, &
    1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1], [3, N_SYSTEMS])
  integer, parameter :: DIRECTIONS(3, N_SYSTEMS) = reshape([1, -1, 0, 1, 0, -1, 0, 1, -1, 0, 1, 1, 1, 0, -1, 1, 1, 0, &
    0, 1, -1, 1, 0, 1, 1, 1, 0, 0, 1, 1, 1, 0, 1, 1, -1, 0, &
    0, 1, 1, 0, 1, -1, 1, 0, 1, 1, 0, -1, 1, 1, 0, 1, -1, 0], [3, N_SYSTEMS])
  real(DP), parameter :: MUTUAL_HARDENING = -0.1_DP   !< h between the systems of a family [-]

  integer, parameter :: MAX_SLIP_ITERATIONS = 100
  integer, parameter :: MAX_SLIP_HALVINGS = 40
  real(DP), parameter :: TOL_RESIDUAL = 1.0e-12_DP     !< of the largest resolved trial stress: solved [-]
  real(DP), parameter :: TOL_ACCEPTABLE = 1.0e-9_DP    !< the same where rounding ends the iterations [-]

  !> Result of an increment.
  type :: crystal_return_type
    real(DP) :: stress(6) = 0                      !< [stress]
    real(DP) :: tangent(6, 6) = 0                  !< engineering shears [stress]
    real(DP) :: flow(6) = 0                        !< plastic strain of the increment, tensor components [-]
    real(DP) :: plastic = 0                        !< its equivalent, sqrt(2/3 flow : flow) [-]
  end type crystal_return_type

  !> The fixed data of an increment.
  type :: crystal_problem_type
    real(DP) :: constants(N_CRYSTAL_CONSTANTS, N_SYSTEMS)   !< of the family of each system
    real(DP) :: G(N_SYSTEMS, N_SYSTEMS)            !< m : C : m [stress]
    real(DP) :: trial(N_SYSTEMS)                   !< resolved stress of the trial strain [stress]
    real(DP) :: limit_old(N_SYSTEMS), back_old(N_SYSTEMS), slip_old(N_SYSTEMS)   !< R, x [stress] and v [-]
    real(DP) :: dt                                 !< [time]
  end type crystal_problem_type

  !> The state at an estimate.
  type :: crystal_slip_type
    real(DP) :: y(N_SYSTEMS) = 0                   !< overstress over K [-]
    real(DP) :: slip(N_SYSTEMS) = 0                !< g [-]
    real(DP) :: slope(N_SYSTEMS) = 0               !< dg/dy [-]
    real(DP) :: limit(N_SYSTEMS) = 0               !< R [stress]
    real(DP) :: back(N_SYSTEMS) = 0                !< x [stress]
    logical :: is_active(N_SYSTEMS) = .false.
    real(DP) :: residual(N_SYSTEMS) = 0            !< K y less the overstress [stress]
    real(DP) :: jacobian(N_SYSTEMS, N_SYSTEMS) = 0 !< its derivative by y [stress]
    real(DP) :: merit = 0                          !< sum of squares of residual over K [-]
  end type crystal_slip_type

contains

  !> The constants of slip without limit and hardening: K, n of both families to the nine of each.
  pure function expand_creep_constants(given) result(constants)
    real(DP), intent(in) :: given(:)               !< (4) K, n octahedral, K, n cubic
    real(DP) :: constants(2 * N_CRYSTAL_CONSTANTS)
    constants = 0
    constants(:2) = given(:2)
    constants(N_CRYSTAL_CONSTANTS + 1:N_CRYSTAL_CONSTANTS + 2) = given(3:4)
  end function expand_creep_constants


  !> Stress, tangent and state at the end of an increment.
  pure subroutine map_crystal_return(law, constants, C, frame, e, dt, state, response, status)
    integer, intent(in) :: law                     !< INELASTIC_CRYSTAL or INELASTIC_CRYSTAL_CREEP: the layout of state
    real(DP), intent(in) :: constants(:)           !< (18) of octahedral slip, then of cubic slip
    real(DP), intent(in) :: C(6, 6)                !< elasticity in the global axes, engineering shears [stress]
    real(DP), intent(in) :: frame(3, 3)            !< axes of the crystal in its columns
    real(DP), intent(in) :: e(6)                   !< elastic trial strain, engineering shears [-]
    real(DP), intent(in) :: dt                     !< above 0 [time]
    real(DP), intent(inout) :: state(:)            !< in: at the start; out: at the end
    type(crystal_return_type), intent(out) :: response
    integer, intent(out) :: status                 !< RETURN_...
    type(crystal_problem_type) :: problem
    type(crystal_slip_type) :: now
    real(DP) :: m(6, N_SYSTEMS), Cm(6, N_SYSTEMS), change(N_SYSTEMS, 6), flow(6)
    integer :: i
    m = slip_tensors(frame)
    Cm = matmul(C, m)
    problem%constants(:, :N_OCTAHEDRAL) = spread(constants(:N_CRYSTAL_CONSTANTS), 2, N_OCTAHEDRAL)
    problem%constants(:, N_OCTAHEDRAL + 1:) = spread(constants(N_CRYSTAL_CONSTANTS + 1:), 2, N_SYSTEMS - N_OCTAHEDRAL)
    problem%G = matmul(transpose(m), Cm)
    problem%trial = matmul(transpose(Cm), e)
    problem%dt = dt
    call unpack_state(law, state, problem)
    call solve_slip(problem, now, status)
    if (status /= RETURN_OK) return
    flow = matmul(m, now%slip)
    response%stress = matmul(C, e - flow)
    flow(4:) = 0.5_DP * flow(4:)
    response%flow = flow
    response%plastic = sqrt((sum(flow(:3)**2) + 2 * sum(flow(4:)**2)) * 2 / 3)
    do i = 1, N_SYSTEMS
      change(i, :) = 0
      if (now%is_active(i)) change(i, :) = Cm(:, i)
    end do
    call solve_dense(now%jacobian, change, status)
    if (status /= RETURN_OK) return
    do i = 1, N_SYSTEMS
      change(i, :) = now%slope(i) * change(i, :)
    end do
    response%tangent = C - matmul(Cm, change)
    if (.not. all(ieee_is_finite(response%tangent))) status = RETURN_FAILED
    call pack_state(law, problem, now, flow, state)
  end subroutine map_crystal_return


  !> The orientation tensors in the global axes, with doubled shears.
  pure function slip_tensors(frame) result(m)
    real(DP), intent(in) :: frame(3, 3)
    real(DP) :: m(6, N_SYSTEMS)
    real(DP) :: n(3), l(3)
    integer :: i
    do i = 1, N_SYSTEMS
      n = real(NORMALS(:, i), DP)
      l = real(DIRECTIONS(:, i), DP)
      n = n / norm2(n)
      l = l / norm2(l)
      m(:, i) = [l * n, 0.5_DP * (l(1) * n(2) + l(2) * n(1)), 0.5_DP * (l(2) * n(3) + l(3) * n(2)), &
        0.5_DP * (l(1) * n(3) + l(3) * n(1))]
    end do
    m = matmul(voigt_transformation(frame), m)
    m(4:, :) = 2 * m(4:, :)
  end function slip_tensors


  !> The hardening at the start of the increment.
  pure subroutine unpack_state(law, state, problem)
    integer, intent(in) :: law
    real(DP), intent(in) :: state(:)
    type(crystal_problem_type), intent(inout) :: problem
    problem%limit_old = 0
    problem%back_old = 0
    if (law == INELASTIC_CRYSTAL) then
      problem%limit_old = -state(7:6 + N_SYSTEMS)
      problem%back_old = state(7 + N_SYSTEMS:6 + 2 * N_SYSTEMS)
      problem%slip_old = state(7 + 2 * N_SYSTEMS:6 + 3 * N_SYSTEMS)
    else
      problem%slip_old = state(7:6 + N_SYSTEMS)
    end if
  end subroutine unpack_state


  !> The state at the end of the increment, in the order of CalculiX.
  pure subroutine pack_state(law, problem, now, flow, state)
    integer, intent(in) :: law
    type(crystal_problem_type), intent(in) :: problem
    type(crystal_slip_type), intent(in) :: now
    real(DP), intent(in) :: flow(6)                !< tensor components [-]
    real(DP), intent(inout) :: state(:)
    state(:6) = state(:6) + flow(STATE_ORDER)
    if (law == INELASTIC_CRYSTAL) then
      state(7:6 + N_SYSTEMS) = -now%limit
      state(7 + N_SYSTEMS:6 + 2 * N_SYSTEMS) = now%back
      state(7 + 2 * N_SYSTEMS:6 + 3 * N_SYSTEMS) = problem%slip_old + abs(now%slip)
    else
      state(7:6 + N_SYSTEMS) = problem%slip_old + abs(now%slip)
    end if
  end subroutine pack_state


  !> The slips of the increment.
  pure subroutine solve_slip(problem, now, status)
    type(crystal_problem_type), intent(in) :: problem
    type(crystal_slip_type), intent(out) :: now
    integer, intent(out) :: status                 !< RETURN_...
    type(crystal_slip_type) :: next
    real(DP) :: excess, factor, step(N_SYSTEMS, 1), J(N_SYSTEMS, N_SYSTEMS), scale
    integer :: i, k, halving
    call evaluate_slip(problem, now)               ! of no slip
    status = RETURN_OK
    if (.not. any(now%is_active)) return
    do i = 1, N_SYSTEMS
      excess = -now%residual(i)
      if (.not. now%is_active(i)) cycle
      associate (viscosity => problem%constants(1, i), n => problem%constants(2, i))
        now%y(i) = sign(min(abs(excess) / viscosity, (abs(excess) / (problem%G(i, i) * problem%dt))**(1 / n)), excess)
      end associate
    end do
    call evaluate_slip(problem, now)
    scale = maxval(abs(problem%trial))
    do k = 1, MAX_SLIP_ITERATIONS
      if (maxval(abs(now%residual)) <= TOL_RESIDUAL * scale) return
      J = now%jacobian
      step(:, 1) = -now%residual
      call solve_dense(J, step, status)
      if (status /= RETURN_OK) return
      factor = 1
      do halving = 0, MAX_SLIP_HALVINGS
        next%y = now%y + factor * step(:, 1)
        call evaluate_slip(problem, next)
        if (next%merit < now%merit) exit           ! not so of what is not finite
        factor = 0.5_DP * factor
      end do
      if (.not. next%merit < now%merit) exit
      now = next
    end do
    if (maxval(abs(now%residual)) > TOL_ACCEPTABLE * scale) status = RETURN_FAILED
  end subroutine solve_slip


  !> Residual and Jacobian at y.
  pure subroutine evaluate_slip(problem, now)
    type(crystal_problem_type), intent(in) :: problem
    type(crystal_slip_type), intent(inout) :: now    !< in: y; out: the rest
    real(DP) :: stress(N_SYSTEMS), size, fading, dlimit(N_SYSTEMS), dback(N_SYSTEMS), excess
    integer :: i, j
    do i = 1, N_SYSTEMS
      associate (n => problem%constants(2, i), c => problem%constants(3, i), d => problem%constants(4, i), &
        phi => problem%constants(5, i), delta => problem%constants(6, i), Q => problem%constants(8, i), &
        b => problem%constants(9, i), y => now%y(i))
        now%slip(i) = sign(problem%dt * abs(y)**n, y)
        now%slope(i) = problem%dt * n * abs(y)**(n - 1)
        size = abs(now%slip(i))
        fading = (1 - phi) * exp(-delta * (problem%slip_old(i) + size))
        now%back(i) = (problem%back_old(i) - c * (phi + fading) * now%slip(i)) / (1 + d * size)
        dback(i) = (-c * (phi + fading * (1 - delta * size)) - sign(d, y) * now%back(i)) / (1 + d * size)
        now%limit(i) = (problem%limit_old(i) + b * Q * size) / (1 + b * size)
        dlimit(i) = sign(1.0_DP, y) * b * (Q - now%limit(i)) / (1 + b * size)
      end associate
    end do
    stress = problem%trial - matmul(problem%G, now%slip) + now%back
    now%jacobian = 0
    do i = 1, N_SYSTEMS
      associate (viscosity => problem%constants(1, i), r0 => problem%constants(7, i))
        excess = abs(stress(i)) - r0 - dot_product(interaction(i), now%limit)
        now%is_active(i) = excess > 0
        now%residual(i) = viscosity * now%y(i) - sign(max(excess, 0.0_DP), stress(i))
        if (now%is_active(i)) now%jacobian(i, :) = (problem%G(i, :) + sign(1.0_DP, stress(i)) * interaction(i) * dlimit &
          - dback * [(merge(1.0_DP, 0.0_DP, i == j), j=1, N_SYSTEMS)]) * now%slope
        now%jacobian(i, i) = now%jacobian(i, i) + viscosity
      end associate
    end do
    now%merit = sum((now%residual / problem%constants(1, :))**2)
  end subroutine evaluate_slip


  !> The row h_i of the interaction matrix.
  pure function interaction(i) result(h)
    integer, intent(in) :: i                       !< system
    real(DP) :: h(N_SYSTEMS)
    h = 0
    if (i <= N_OCTAHEDRAL) then
      h(:N_OCTAHEDRAL) = MUTUAL_HARDENING
    else
      h(N_OCTAHEDRAL + 1:) = MUTUAL_HARDENING
    end if
    h(i) = 1
  end function interaction


  !> B becomes A^-1 B, by Gaussian elimination with row exchange; A is overwritten.
  pure subroutine solve_dense(A, B, status)
    real(DP), intent(inout) :: A(:, :), B(:, :)
    integer, intent(out) :: status                 !< RETURN_...
    real(DP) :: row(size(A, 2)), rows(size(B, 2)), factor
    integer :: i, k, n, pivot
    status = RETURN_FAILED
    n = size(A, 1)
    do k = 1, n
      pivot = k - 1 + maxloc(abs(A(k:, k)), dim=1)
      if (.not. (abs(A(pivot, k)) > 0 .and. ieee_is_finite(A(pivot, k)))) return
      row = A(k, :)
      A(k, :) = A(pivot, :)
      A(pivot, :) = row
      rows = B(k, :)
      B(k, :) = B(pivot, :)
      B(pivot, :) = rows
      do i = k + 1, n
        factor = A(i, k) / A(k, k)
        A(i, k:) = A(i, k:) - factor * A(k, k:)
        B(i, :) = B(i, :) - factor * B(k, :)
      end do
    end do
    do k = n, 1, -1
      do i = k + 1, n
        B(k, :) = B(k, :) - A(k, i) * B(i, :)
      end do
      B(k, :) = B(k, :) / A(k, k)
    end do
    status = RETURN_OK
  end subroutine solve_dense

end module amontons_crystal_plasticity
