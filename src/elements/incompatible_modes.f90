!> Incompatible modes of C3D8I, CPS4I, CPE4I, CAX4I: gradients, Newton update of their amplitudes, static condensation.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Three additional shape functions, 1 - xi_m^2, with amplitudes local to the element. With their gradients formed with
!! the Jacobian of the centre and scaled by the ratio of the determinants,
!!
!!     G_m = xi_m (j_0 / j) J_0^-T e_m,
!!
!! their sum over the points is zero, so that the patch test is passed on distorted elements. In the plane there are two. In an
!! axisymmetric element, whose volumes grow with the radius, constants keep the sum zero, and a fifth amplitude gives a hoop strain
!! xi eta: it leaves one condition on the volume (doc/theory/elements.md, "Incompatible modes in the plane").
!!
!! References: R. L. Taylor, P. J. Beresford, E. L. Wilson, A non-conforming element for stress analysis, Int. J. Numer.
!! Meth. Engng 10 (1976) 1211-1219; J. C. Simo, M. S. Rifai, A class of mixed assumed strain methods and the method of
!! incompatible modes, Int. J. Numer. Meth. Engng 29 (1990) 1595-1638; J. C. Simo, F. Armero, Geometrically non-linear
!! enhanced strain mixed methods and the method of incompatible modes, Int. J. Numer. Meth. Engng 33 (1992) 1413-1449.
module amontons_incompatible_modes
  use amontons_kinds, only: DP
  use amontons_tensor, only: invert
  use amontons_element_kinds, only: MAX_ELEMENT_NODES
  implicit none
  private
  public :: mode_iteration_type, evaluate_mode_gradients, evaluate_plane_mode_gradients, correct_mode_amplitudes, &
    update_mode_amplitudes, halve_mode_correction, condense_mode_amplitudes, add_mode_skew_part
  public :: N_MODES, MAX_AMPLITUDE_CORRECTIONS, TOL_MODE_FORCE, TOL_MODE_FORCE_ACCEPTABLE

  integer, parameter :: N_MODES = 3                !< vectors of amplitudes: nine numbers
  integer, parameter :: MAX_AMPLITUDE_CORRECTIONS = 60      !< of the amplitudes, also of solid shells
  real(DP), parameter :: TOL_MODE_FORCE = 1.0e-14_DP        !< force of the amplitudes over that of the stresses: converged [-]
  real(DP), parameter :: TOL_MODE_FORCE_ACCEPTABLE = 1.0e-9_DP    !< where the corrections end [-]

  real(DP), parameter :: MIN_STEP_LENGTH = 0.05_DP        !< a correction shortened below this is accepted [-]
  real(DP), parameter :: TOL_AMPLITUDE_ROUNDING = 1.0e-14_DP     !< a correction this small over the displacements is rounding [-]

  !> The search for the amplitudes of an element.
  type :: mode_iteration_type
    real(DP) :: correction(3, N_MODES) = 0         !< the last [length]
    real(DP) :: share = 0                          !< fraction of the correction applied [-]
    real(DP) :: slope = 0                          !< of the energy along it, where it began [energy]
  end type mode_iteration_type

contains

  !> The gradients of the modes at the integration points.
  pure subroutine evaluate_mode_gradients(X, xi, determinants, gradients)
    real(DP), intent(in) :: X(:, :)                !< (3, 8) reference coordinates [length]
    real(DP), intent(in) :: xi(:, :)               !< (3, points) natural coordinates of the points [-]
    real(DP), intent(in) :: determinants(:)        !< (points) of the Jacobian there [length^3]
    real(DP), intent(out) :: gradients(:, :, :)    !< (N_MODES, 3, points) [1/length]
    real(DP), parameter :: CORNER_SIGNS(3, 8) = reshape([real(DP) :: &
      -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])
    real(DP) :: J(3, 3), inverse(3, 3), det
    integer :: m, p
    J = matmul(X(:, :8), transpose(CORNER_SIGNS)) / 8
    call invert(J, inverse, det)
    do p = 1, size(determinants)
      do m = 1, N_MODES
        gradients(m, :, p) = (xi(m, p) * det / determinants(p)) * inverse(m, :)
      end do
    end do
  end subroutine evaluate_mode_gradients


  !> The gradients of both modes of a quadrilateral at the 2x2 points. Of an axisymmetric one also what the gradient of the radial
  !! displacement has more, and the hoop strains of the radial amplitudes and of a third mode.
  !!
  !! With r = r_0 + r_1 xi + r_2 eta + r_3 xi eta and volumes w_p r_p j_p, and g_m = d xi_m/d r in the centre,
  !!
  !!     G_m    = (xi_m - r_m/(3 r_0)) (j_0/j) J_0^-T e_m            sum zero
  !!     pair   : rr  r_m g_m/(3 r_0) j_0/j,   hoop  -r_m g_m/(3 r) j_0/j       sum of both zero
  !!     third  : hoop  (xi eta - r_3/(9 r_0)) (j_0/j)/r_0           sum zero
  !!
  !! so that no stress with equal radial and hoop parts does work in them, as the patch test requires. The pair makes the radial
  !! mode the displacement 1 - xi^2 with its own hoop strain: a tube under pressure has exact displacements of the nodes.
  !! Reference: Simo and Rifai 1990, but for the pair.
  pure subroutine evaluate_plane_mode_gradients(X, xi, is_axisymmetric, gradients, radial, hoop)
    real(DP), intent(in) :: X(:, :)                !< (>= 2, 4) reference coordinates [length]
    real(DP), intent(in) :: xi(:, :)               !< (>= 2, 4) natural coordinates of the points [-]
    logical, intent(in) :: is_axisymmetric         !< x is the radius
    real(DP), intent(out) :: gradients(:, :, :)    !< (2 modes, 2, 4) [1/length]
    real(DP), intent(out) :: radial(:, :)          !< (2 modes, 4) more of d u_x/d x; 0 in the plane [1/length]
    real(DP), intent(out) :: hoop(:, :)            !< (3 modes, 4) of a radial amplitude of 1; 0 in the plane [1/length]
    real(DP), parameter :: FIELDS(4, 0:3) = reshape([real(DP) :: 1, 1, 1, 1, -1, 1, 1, -1, -1, -1, 1, 1, 1, -1, 1, -1], [4, 4])
    real(DP) :: parts(2, 0:3), J(2, 2), inverse(2, 2), det, ratio, shift(3), radius
    integer :: p, m
    parts = matmul(X(:2, :4), FIELDS) / 4
    shift = 0
    if (is_axisymmetric) shift = parts(1, 1:3) / (parts(1, 0) * [3.0_DP, 3.0_DP, 9.0_DP])
    det = parts(1, 1) * parts(2, 2) - parts(1, 2) * parts(2, 1)
    inverse = reshape([parts(2, 2), -parts(2, 1), -parts(1, 2), parts(1, 1)], [2, 2]) / det
    hoop = 0
    do p = 1, 4
      J(:, 1) = parts(:, 1) + xi(2, p) * parts(:, 3)
      J(:, 2) = parts(:, 2) + xi(1, p) * parts(:, 3)
      ratio = det / (J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1))
      radius = dot_product(parts(1, :), [1.0_DP, xi(1, p), xi(2, p), xi(1, p) * xi(2, p)])
      do m = 1, 2
        gradients(m, :, p) = (xi(m, p) - shift(m)) * ratio * inverse(m, :)
        radial(m, p) = shift(m) * ratio * inverse(m, 1)
        if (is_axisymmetric) hoop(m, p) = -radial(m, p) * parts(1, 0) / radius
      end do
      if (is_axisymmetric) hoop(3, p) = (xi(1, p) * xi(2, p) - shift(3)) * ratio / parts(1, 0)
    end do
  end subroutine evaluate_plane_mode_gradients


  !> The next amplitudes of the search for zero forces of the modes: half of a correction that inverted the element, else an update.
  pure subroutine correct_mode_amplitudes(iteration, n, is_valid, force, stiffness, u, residual, is_done)
    type(mode_iteration_type), intent(inout) :: iteration
    integer, intent(in) :: n                       !< nodes; the modes follow
    logical, intent(in) :: is_valid                !< the element was evaluated; else its forces are undefined
    real(DP), intent(in) :: force(3, MAX_ELEMENT_NODES)
    real(DP), intent(in) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP), intent(inout) :: u(:, :)             !< (3, n + N_MODES) displacements, then amplitudes [length]
    real(DP), intent(inout) :: residual            !< of the modes; 0 where the last update was exact [-]
    logical, intent(out) :: is_done                !< found, or there is no further correction
    logical :: is_exact, is_regular
    if (.not. is_valid) then
      call halve_mode_correction(iteration, u(:, n + 1:), is_regular)
      is_done = .not. is_regular
      return
    end if
    is_done = residual <= TOL_MODE_FORCE
    if (is_done) return
    call update_mode_amplitudes(iteration, n, force, stiffness, u, is_exact, is_regular)
    if (is_exact) residual = 0
    is_done = is_exact .or. .not. is_regular
  end subroutine correct_mode_amplitudes


  !> Updates the amplitudes: a Newton correction, or, if the last one passed the energy minimum, a secant step back.
  !! Without the secant step an element that yields and unloads in turn would oscillate.
  pure subroutine update_mode_amplitudes(iteration, n, force, stiffness, u, is_exact, is_regular)
    type(mode_iteration_type), intent(inout) :: iteration
    integer, intent(in) :: n                       !< nodes of the element
    real(DP), intent(in) :: force(3, MAX_ELEMENT_NODES)    !< of the n nodes and the N_MODES amplitudes [force]
    real(DP), intent(in) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< likewise [force/length]
    real(DP), intent(inout) :: u(:, :)             !< (3, n + N_MODES) displacements and amplitudes [length]
    logical, intent(out) :: is_exact               !< the correction would be rounding: u is as it was
    logical, intent(out) :: is_regular             !< .false.: K_mm is singular
    real(DP) :: slope, previous_slope
    is_exact = .false.
    is_regular = .true.
    associate (modes => force(:, n + 1:n + N_MODES), amplitudes => u(:, n + 1:n + N_MODES))
      slope = sum(modes * iteration%correction)
      if (iteration%share > MIN_STEP_LENGTH .and. slope > abs(iteration%slope)) then
        previous_slope = iteration%share
        iteration%share = previous_slope * abs(iteration%slope) / (abs(iteration%slope) + slope)
        amplitudes = amplitudes + (iteration%share - previous_slope) * iteration%correction
        return
      end if
      call find_mode_correction(n, force, stiffness, iteration%correction, is_regular)
      if (.not. is_regular) return
      is_exact = maxval(abs(iteration%correction)) <= TOL_AMPLITUDE_ROUNDING * max(maxval(abs(amplitudes)), &
        maxval(abs(u(:, 2:n) - spread(u(:, 1), 2, n - 1))))
      if (is_exact) return
      iteration%share = 1
      iteration%slope = sum(modes * iteration%correction)
      amplitudes = amplitudes + iteration%correction
    end associate
  end subroutine update_mode_amplitudes


  !> Takes back half of the last correction, which gave a configuration that is not valid.
  pure subroutine halve_mode_correction(iteration, amplitudes, is_possible)
    type(mode_iteration_type), intent(inout) :: iteration
    real(DP), intent(inout) :: amplitudes(:, :)    !< (3, N_MODES) [length]
    logical, intent(out) :: is_possible            !< .false.: there is no correction, or it is as short as allowed
    is_possible = iteration%share > MIN_STEP_LENGTH
    if (.not. is_possible) return
    iteration%share = 0.5_DP * iteration%share
    amplitudes = amplitudes - iteration%share * iteration%correction
  end subroutine halve_mode_correction


  !> The Newton correction of the amplitudes, which are the last nodes of the element: -K_mm^-1 f_m.
  pure subroutine find_mode_correction(n, force, stiffness, correction, is_regular)
    integer, intent(in) :: n                       !< nodes of the element
    real(DP), intent(in) :: force(3, MAX_ELEMENT_NODES)    !< of the n nodes and the N_MODES amplitudes [force]
    real(DP), intent(in) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< likewise [force/length]
    real(DP), intent(out) :: correction(3, N_MODES)
    logical, intent(out) :: is_regular             !< .false.: K_mm is singular
    real(DP) :: A(3 * N_MODES, 3 * N_MODES), b(3 * N_MODES, 1)
    associate (first => 3 * n + 1, last => 3 * (n + N_MODES))
      A = stiffness(first:last, first:last)
    end associate
    b(:, 1) = -reshape(force(:, n + 1:n + N_MODES), [3 * N_MODES])
    call solve_with_pivoting(A, b, is_regular)
    correction = reshape(b(:, 1), [3, N_MODES])
  end subroutine find_mode_correction


  !> Adds the contribution of an unsymmetric law: the sum of V B' w B over the points, B the strains of nodes and modes.
  pure subroutine add_mode_skew_part(n, gradients, volume, w, stiffness)
    integer, intent(in) :: n                       !< nodes and modes
    real(DP), intent(in) :: gradients(:, :, :)     !< (>= n, 3, >= points) of the present configuration [1/length]
    real(DP), intent(in) :: volume(:)              !< (points) at rest [length^3]
    real(DP), intent(in) :: w(:, :, :)             !< (6, 6, >= points) (c - c')/2, engineering shears [stress]
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< set up to 3 n [force/length]
    real(DP) :: B(6, 3 * n), g(3)
    integer :: p, a
    do p = 1, size(volume)
      B = 0
      do a = 1, n
        g = gradients(a, :, p)
        B(:, 3 * a - 2) = [g(1), 0.0_DP, 0.0_DP, g(2), 0.0_DP, g(3)]
        B(:, 3 * a - 1) = [0.0_DP, g(2), 0.0_DP, g(1), g(3), 0.0_DP]
        B(:, 3 * a) = [0.0_DP, 0.0_DP, g(3), 0.0_DP, g(2), g(1)]
      end do
      stiffness(:3 * n, :3 * n) = stiffness(:3 * n, :3 * n) + volume(p) * matmul(transpose(B), matmul(w(:, :, p), B))
    end do
  end subroutine add_mode_skew_part


  !> Takes the amplitudes out of the tangent: K = K_uu - K_um K_mm^-1 K_mu, and out of the forces, where they are zero.
  pure subroutine condense_mode_amplitudes(n, is_symmetric, force, stiffness, is_regular)
    integer, intent(in) :: n                       !< nodes of the element
    logical, intent(in) :: is_symmetric            !< the tangent is; then it stays so to the last bit
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES) !< [force]
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< set up to 3 n [force/length]
    logical, intent(out) :: is_regular             !< .false.: K_mm is singular
    real(DP) :: A(3 * N_MODES, 3 * N_MODES), b(3 * N_MODES, 3 * MAX_ELEMENT_NODES), left(3 * N_MODES, 3 * n)
    integer :: i, j
    associate (first => 3 * n + 1, last => 3 * (n + N_MODES))
      A = stiffness(first:last, first:last)
      b(:, :3 * n) = stiffness(first:last, :3 * n)
      left = transpose(stiffness(:3 * n, first:last))
      call solve_with_pivoting(A, b(:, :3 * n), is_regular)
      do j = 1, 3 * n
        do i = j, 3 * n
          stiffness(i, j) = stiffness(i, j) - dot_product(left(:, i), b(:, j))
          if (is_symmetric) then
            stiffness(j, i) = stiffness(i, j)
          else if (i > j) then
            stiffness(j, i) = stiffness(j, i) - dot_product(left(:, j), b(:, i))
          end if
        end do
      end do
    end associate
    force(:, n + 1:) = 0
  end subroutine condense_mode_amplitudes


  !> Solves A x = b by elimination with row exchanges; A is overwritten, b becomes x.
  pure subroutine solve_with_pivoting(A, b, is_regular)
    real(DP), intent(inout) :: A(:, :), b(:, :)
    logical, intent(out) :: is_regular
    real(DP) :: row(size(A, 2)), right(size(b, 2))
    integer :: k, i, best
    do k = 1, size(A, 1)
      best = k - 1 + maxloc(abs(A(k:, k)), 1)
      is_regular = abs(A(best, k)) > 0
      if (.not. is_regular) return
      row = A(best, :)
      A(best, :) = A(k, :)
      A(k, :) = row
      right = b(best, :)
      b(best, :) = b(k, :)
      b(k, :) = right
      do i = k + 1, size(A, 1)
        row(k) = A(i, k) / A(k, k)
        A(i, k:) = A(i, k:) - row(k) * A(k, k:)
        b(i, :) = b(i, :) - row(k) * b(k, :)
      end do
    end do
    do k = size(A, 1), 1, -1
      do i = k + 1, size(A, 1)
        b(k, :) = b(k, :) - A(k, i) * b(i, :)
      end do
      b(k, :) = b(k, :) / A(k, k)
    end do
  end subroutine solve_with_pivoting

end module amontons_incompatible_modes
