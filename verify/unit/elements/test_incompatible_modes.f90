!> Unit test of amontons_incompatible_modes: gradients, correction of the amplitudes, condensation against block elimination.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_incompatible_modes
  use amontons_incompatible_modes, only: mode_iteration_type, evaluate_mode_gradients, evaluate_plane_mode_gradients, &
    update_mode_amplitudes, condense_mode_amplitudes, add_mode_skew_part, N_MODES
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: MAX_ELEMENT_NODES
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: N_DOF = 3 * MAX_ELEMENT_NODES, N = 8, FIRST = 3 * N + 1, LAST = 3 * (N + N_MODES)
  integer :: i, n_seed
  call random_seed(size=n_seed)
  call random_seed(put=[(86028157 + 31 * i, i=1, n_seed)])
  call check_gradients()
  call check_plane_gradients()
  call check_correction()
  call check_secant()
  call check_condensation(.true.)
  call check_condensation(.false.)
  call check_skew_part()
  call suite%finish()

contains

  !> On a brick the modes are 1 - xi^2; on any hexahedron their gradients add up to nothing.
  subroutine check_gradients()
    real(DP) :: X(3, 8), r(3, 8), xi(3, 8), det(8), gradients(N_MODES, 3, 8), J(3, 3)
    real(DP), parameter :: SIGNS(3, 8) = reshape([real(DP) :: &
      -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])
    integer :: p, a, k
    xi = SIGNS / sqrt(3.0_DP)
    X = SIGNS
    X(2, :) = 2 * X(2, :)
    det = 2
    call evaluate_mode_gradients(X, xi, det, gradients)
    call suite%near('brick: along x', gradients(1, 1, 2), 1 / sqrt(3.0_DP), 1.0e-15_DP)
    call suite%near('brick: along y, twice as long', gradients(2, 2, 2), -0.5_DP / sqrt(3.0_DP), 1.0e-15_DP)
    call suite%near('brick: no other direction', abs(gradients(1, 2, 2)) + abs(gradients(3, 1, 2)), 0.0_DP, 1.0e-15_DP)
    call random_number(r)
    X = X + 0.4_DP * (r - 0.5_DP)
    do p = 1, 8
      J = 0
      do a = 1, 8
        do k = 1, 3
          J(:, k) = J(:, k) + X(:, a) * SIGNS(k, a) / 8 &
            * product(1 + SIGNS(:, a) * xi(:, p)) / (1 + SIGNS(k, a) * xi(k, p))
        end do
      end do
      det(p) = J(1, 1) * (J(2, 2) * J(3, 3) - J(2, 3) * J(3, 2)) - J(1, 2) * (J(2, 1) * J(3, 3) - J(2, 3) * J(3, 1)) &
        + J(1, 3) * (J(2, 1) * J(3, 2) - J(2, 2) * J(3, 1))
    end do
    call evaluate_mode_gradients(X, xi, det, gradients)
    do k = 1, 3
      call suite%near('patch test: sum over the points', norm2(matmul(gradients(:, k, :), det)), 0.0_DP, 1.0e-14_DP)
    end do
    call suite%that('and they are not zero', norm2(gradients) > 1)
  end subroutine check_gradients


  !> In the plane the gradients add up to nothing. Around an axis stresses with equal radial and hoop parts do no work; on a
  !! rectangle the radial mode is -(1 - xi^2)/2 with its hoop strain.
  subroutine check_plane_gradients()
    real(DP), parameter :: SIGNS(2, 4) = reshape([real(DP) :: -1, -1, 1, -1, -1, 1, 1, 1], [2, 4])
    real(DP), parameter :: CORNERS(2, 4) = reshape([real(DP) :: -1, -1, 1, -1, 1, 1, -1, 1], [2, 4])
    real(DP) :: X(2, 4), r(2, 4), xi(2, 4), gradients(2, 2, 4), radial(2, 4), hoop(3, 4), N(4), dN(2, 4), J(2, 2), det(4), &
      radius(4), work
    integer :: m, p, round
    logical :: is_axisymmetric
    xi = SIGNS / sqrt(3.0_DP)
    do round = 1, 2
      is_axisymmetric = round == 2
      call random_number(r)
      X = matmul(reshape([1.3_DP, 0.4_DP, -0.5_DP, 0.8_DP], [2, 2]), CORNERS) + 0.5_DP * r
      X(1, :) = X(1, :) + 3
      do p = 1, 4
        N = (1 + CORNERS(1, :) * xi(1, p)) * (1 + CORNERS(2, :) * xi(2, p)) / 4
        dN(1, :) = CORNERS(1, :) * (1 + CORNERS(2, :) * xi(2, p)) / 4
        dN(2, :) = CORNERS(2, :) * (1 + CORNERS(1, :) * xi(1, p)) / 4
        J = matmul(X, transpose(dN))
        radius(p) = dot_product(X(1, :), N)
        det(p) = (J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)) * merge(radius(p), 1.0_DP, is_axisymmetric)
      end do
      call evaluate_plane_mode_gradients(X, xi, is_axisymmetric, gradients, radial, hoop)
      do m = 1, 2
        call suite%near('plane: gradients', norm2(matmul(gradients(m, :, :), det)), 0.0_DP, 1.0e-14_DP)
        work = dot_product(radial(m, :) + hoop(m, :), det)
        call suite%near('plane: equal radial and hoop stress', work, 0.0_DP, 1.0e-14_DP)
      end do
      call suite%near('plane: hoop stress in the third mode', dot_product(hoop(3, :), det), 0.0_DP, 1.0e-14_DP)
      if (.not. is_axisymmetric) call suite%that('plane: no more', all(radial == 0) .and. all(hoop == 0))
    end do
    call suite%that('not zero', norm2(gradients) > 1 .and. norm2(hoop(3, :)) > 0.1_DP .and. norm2(radial) > 0.1_DP)
    X = CORNERS
    X(1, :) = 2 * X(1, :) + 5
    call evaluate_plane_mode_gradients(X, xi, .true., gradients, radial, hoop)
    call suite%near('rectangle: radial', maxval(abs(gradients(1, 1, :) + radial(1, :) - xi(1, :) / 2)), 0.0_DP, 1.0e-15_DP)
    call suite%near('rectangle: hoop', maxval(abs(hoop(1, :) + (1 - xi(1, :)**2) / 2 / (5 + 2 * xi(1, :)))), 0.0_DP, 1.0e-15_DP)
    call suite%near('rectangle: across', maxval(abs(gradients(2, 2, :) - xi(2, :))), 0.0_DP, 1.0e-15_DP)
    call suite%near('rectangle: nothing else', maxval(abs(hoop(2, :))) + maxval(abs(radial(2, :))), 0.0_DP, 1.0e-15_DP)
  end subroutine check_plane_gradients


  !> A quadratic energy is at its least after one correction, and then the next is rounding. A singular block is reported.
  subroutine check_correction()
    real(DP) :: K(N_DOF, N_DOF), force(3, MAX_ELEMENT_NODES), u(3, N + N_MODES), f(LAST)
    type(mode_iteration_type) :: iteration
    logical :: is_exact, is_regular
    integer :: round
    call make_stiffness(.true., K)
    call random_number(u)
    do round = 1, 3
      f = matmul(K(:LAST, :LAST), reshape(u, [LAST]))
      force(:, :N + N_MODES) = reshape(f, [3, N + N_MODES])
      if (round > 1) call suite%near('no force on the modes', norm2(f(FIRST:)), 0.0_DP, 1.0e-12_DP)
      call update_mode_amplitudes(iteration, N, force, K, u, is_exact, is_regular)
      call suite%that('regular', is_regular)
      if (round == 1) call suite%that('not yet exact', .not. is_exact .and. iteration%share == 1 .and. iteration%slope < 0)
    end do
    call suite%that('exact at the end', is_exact)
    K(FIRST, :) = 0
    iteration = mode_iteration_type()
    call update_mode_amplitudes(iteration, N, force, K, u, is_exact, is_regular)
    call suite%that('singular', .not. is_regular)
  end subroutine check_correction


  !> A correction that went past the least energy goes back to where the secant of the slopes is zero.
  subroutine check_secant()
    real(DP) :: K(N_DOF, N_DOF), force(3, MAX_ELEMENT_NODES), u(3, N + N_MODES)
    type(mode_iteration_type) :: iteration
    logical :: is_exact, is_regular
    call make_stiffness(.true., K)
    u = 0
    force = 0
    iteration%correction(2, 1) = 1
    iteration%share = 1
    iteration%slope = -1
    force(2, N + 1) = 3                            ! slope 3 at the end, -1 at the start: zero at a quarter
    u(2, N + 1) = 1
    call update_mode_amplitudes(iteration, N, force, K, u, is_exact, is_regular)
    call suite%near('back to a quarter', u(2, N + 1), 0.25_DP, 1.0e-15_DP)
    call suite%near('that share is noted', iteration%share, 0.25_DP, 1.0e-15_DP)
    call suite%that('it is no end', .not. is_exact .and. is_regular)
    iteration%share = 0.04_DP
    call update_mode_amplitudes(iteration, N, force, K, u, is_exact, is_regular)
    call suite%near('too short a share: a new correction', iteration%share, 1.0_DP, 0.0_DP)
  end subroutine check_secant


  !> K_uu - K_um inv(K_mm) K_mu; amplitudes that follow give no force. A symmetric tangent stays so to the last bit.
  subroutine check_condensation(is_symmetric)
    logical, intent(in) :: is_symmetric
    real(DP) :: K(N_DOF, N_DOF), whole(N_DOF, N_DOF), force(3, MAX_ELEMENT_NODES), u(LAST), f(LAST)
    type(mode_iteration_type) :: iteration
    real(DP) :: both(3, N + N_MODES)
    logical :: is_regular, is_exact
    call make_stiffness(is_symmetric, K)
    whole = K
    call random_number(both)
    both(:, N + 1:) = 0
    force(:, :N + N_MODES) = reshape(matmul(K(:LAST, :LAST), reshape(both, [LAST])), [3, N + N_MODES])
    call update_mode_amplitudes(iteration, N, force, K, both, is_exact, is_regular)
    u = reshape(both, [LAST])
    f = matmul(whole(:LAST, :LAST), u)
    call condense_mode_amplitudes(N, is_symmetric, force, K, is_regular)
    call suite%that('condensed', is_regular)
    call suite%near('the same force of the nodes', norm2(matmul(K(:3 * N, :3 * N), u(:3 * N)) - f(:3 * N)), 0.0_DP, 1.0e-11_DP)
    call suite%that('no force of the modes', all(force(:, N + 1:N + N_MODES) == 0))
    if (is_symmetric) call suite%that('symmetric', all(K(:3 * N, :3 * N) == transpose(K(:3 * N, :3 * N))))
    whole(FIRST:LAST, FIRST:LAST) = 0
    call condense_mode_amplitudes(N, is_symmetric, force, whole, is_regular)
    call suite%that('singular block', .not. is_regular)
  end subroutine check_condensation


  !> The skew part adds no work: v' K v = 0; the force it gives is that of the stresses w e.
  subroutine check_skew_part()
    real(DP) :: K(N_DOF, N_DOF), gradients(N, 3, 2), w(6, 6, 2), u(3, N), f(3, N), e(6), s(6), H(3, 3)
    integer :: p
    K = 0
    call random_number(gradients)
    call random_number(w)
    call random_number(u)
    f = 0
    do p = 1, 2
      w(:, :, p) = w(:, :, p) - transpose(w(:, :, p))
      H = matmul(u, gradients(:, :, p))
      e = [H(1, 1), H(2, 2), H(3, 3), H(1, 2) + H(2, 1), H(2, 3) + H(3, 2), H(1, 3) + H(3, 1)]
      s = matmul(w(:, :, p), e)
      f = f + real(p, DP) * matmul(reshape([s(1), s(4), s(6), s(4), s(2), s(5), s(6), s(5), s(3)], [3, 3]), &
        transpose(gradients(:, :, p)))
    end do
    call add_mode_skew_part(N, gradients, [1.0_DP, 2.0_DP], w, K)
    call suite%near('force of w e', norm2(matmul(K(:3 * N, :3 * N), reshape(u, [3 * N])) - reshape(f, [3 * N])), 0.0_DP, &
      1.0e-11_DP)
    call suite%near('skew', norm2(K + transpose(K)), 0.0_DP, 1.0e-12_DP)
    call suite%that('not zero', norm2(K) > 1)
  end subroutine check_skew_part


  !> A stiffness with a positive definite symmetric part.
  subroutine make_stiffness(is_symmetric, K)
    logical, intent(in) :: is_symmetric
    real(DP), intent(out) :: K(N_DOF, N_DOF)
    real(DP) :: A(LAST, LAST)
    integer :: i
    call random_number(A)
    K = 0
    K(:LAST, :LAST) = A
    if (is_symmetric) K(:LAST, :LAST) = 0.5_DP * (A + transpose(A))
    do i = 1, LAST
      K(i, i) = K(i, i) + 25
    end do
  end subroutine make_stiffness

end program test_incompatible_modes
