!> Tests of nonlinear MPCs: rotations, rows against differences of their functions, second derivatives, multipliers.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_nonlinear_mpc
  use amontons_kinds, only: DP
  use amontons_nonlinear_mpc, only: evaluate_mpc_rows, evaluate_mpc_hessian, list_hessian_nodes
  use amontons_constraints, only: constraints_type, constraint_row_type, reset_constraints, prescribe_unknown, add_constraint_row, &
    eliminate_constraints, find_multipliers, ROW_ACCEPTED
  use amontons_mpc_data, only: nonlinear_mpc_type, coordinate_system_type, axes_at, MPC_RIGID_BODY, MPC_PLANE, MPC_STRAIGHT, &
    MPC_DISTANCE, MPC_MEAN_ROTATION, MPC_FITTED_ROTATION
  use amontons_tensor, only: rotation_matrix
  use check, only: suite_type
  implicit none
  integer, parameter :: N_NODES = 7
  type(suite_type) :: suite
  call test_rotation(suite)
  call test_frames(suite)
  call test_rows(suite)
  call test_multipliers(suite)
  call suite%finish()

contains

  !> R is a rotation about w by |w|, and dR its derivative, also near w = 0.
  subroutine test_rotation(suite)
    type(suite_type), intent(inout) :: suite
    real(DP), parameter :: H = 1.0e-6_DP
    real(DP) :: w(3), R(3, 3), dR(3, 3, 3), plus(3, 3), minus(3, 3), unused(3, 3, 3), e(3)
    real(DP), parameter :: SIZES(5) = [0.0_DP, 1.0e-3_DP, 0.0101_DP, 1.0_DP, 3.0_DP]
    integer :: i, k
    do i = 1, size(SIZES)
      w = SIZES(i) * [2.0_DP, -1.0_DP, 2.0_DP] / 3.0_DP
      call rotation_matrix(w, R, dR)
      call suite%near('R R'' = 1', maxval(abs(matmul(R, transpose(R)) - eye())), 0.0_DP, 1.0e-14_DP)
      call suite%near('R w = w', maxval(abs(matmul(R, w) - w)), 0.0_DP, 1.0e-14_DP)
      call suite%near('trace', R(1, 1) + R(2, 2) + R(3, 3), 1.0_DP + 2.0_DP * cos(SIZES(i)), 1.0e-14_DP)
      do k = 1, 3
        e = 0.0_DP
        e(k) = H
        call rotation_matrix(w + e, plus, unused)
        call rotation_matrix(w - e, minus, unused)
        call suite%near('dR', maxval(abs(dR(:, :, k) - (plus - minus) / (2.0_DP * H))), 0.0_DP, 1.0e-9_DP)
      end do
    end do
    call rotation_matrix([0.0_DP, 0.0_DP, acos(0.0_DP)], R, dR)
    call suite%near('a quarter turn about z', R(2, 1), 1.0_DP, 1.0e-15_DP)
  end subroutine test_rotation


  !> The unit matrix.
  pure function eye() result(E)
    real(DP) :: E(3, 3)
    E = reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
  end function eye


  !> Directions of both kinds of rules.
  subroutine test_frames(suite)
    type(suite_type), intent(inout) :: suite
    type(coordinate_system_type) :: rule
    real(DP) :: axes(3, 3)
    rule = coordinate_system_type(is_cylindrical=.true., a=[1.0_DP, 0.0_DP, 0.0_DP], b=[1.0_DP, 0.0_DP, 2.0_DP])
    axes = axes_at(rule, [1.0_DP, 5.0_DP, 7.0_DP])
    call suite%near('out', maxval(abs(axes(:, 1) - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, 1.0e-15_DP)
    call suite%near('around', maxval(abs(axes(:, 2) - [-1.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, 1.0e-15_DP)
    call suite%near('along', maxval(abs(axes(:, 3) - [0.0_DP, 0.0_DP, 1.0_DP])), 0.0_DP, 1.0e-15_DP)
    axes = axes_at(rule, [1.0_DP, 0.0_DP, 7.0_DP])
    call suite%near('on the axis too', maxval(abs(matmul(transpose(axes), axes) - eye())), 0.0_DP, 1.0e-14_DP)
    rule = coordinate_system_type(a=[0.0_DP, 2.0_DP, 0.0_DP], b=[-3.0_DP, 1.0_DP, 0.0_DP])
    axes = axes_at(rule, [9.0_DP, 9.0_DP, 9.0_DP])
    call suite%near('rectangular x', maxval(abs(axes(:, 1) - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, 1.0e-15_DP)
    call suite%near('rectangular y', maxval(abs(axes(:, 2) - [-1.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, 1.0e-15_DP)
  end subroutine test_frames


  !> Every kind of constraint, linear and not: the row is the derivative of its function, the second derivative that of the row.
  subroutine test_rows(suite)
    type(suite_type), intent(inout) :: suite
    type(nonlinear_mpc_type) :: mpc
    real(DP) :: X(3, N_NODES)
    integer :: kind
    X = reshape([0.0_DP, 0.0_DP, 0.0_DP, 2.0_DP, 0.1_DP, 0.0_DP, 0.3_DP, 1.5_DP, 0.2_DP, 0.2_DP, -0.4_DP, 1.7_DP, &
      1.1_DP, 0.9_DP, 0.8_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.6_DP, 0.7_DP, -0.5_DP], [3, N_NODES])
    do kind = MPC_RIGID_BODY, MPC_FITTED_ROTATION
      mpc = nonlinear_mpc_type(kind=kind)
      mpc%card = 'TEST'
      select case (kind)
      case (MPC_RIGID_BODY)
        mpc%node = [1, 2, 3, 4]
        mpc%reference = 5
        mpc%rotation = 6
        mpc%is_bound(2) = .false.
        call check_rows(suite, mpc, X, .true.)
        call check_curvature(suite, mpc, X)
        mpc%expansion = 7
      case (MPC_PLANE)
        mpc%node = [5, 1, 2, 3]
      case (MPC_STRAIGHT)
        mpc%node = [5, 1, 2]
      case (MPC_DISTANCE)
        mpc%node = [5, 4]
      case (MPC_MEAN_ROTATION)
        mpc%node = [1, 2, 3, 4, 7]
        mpc%reference = 6
        mpc%pilot_direction = 2
        mpc%axis = [1.0_DP, 2.0_DP, 2.0_DP] / 3.0_DP
      case (MPC_FITTED_ROTATION)
        mpc%node = [1, 2, 3, 4, 7]
        mpc%rotation = 6
      end select
      call check_rows(suite, mpc, X, .true.)
      call check_rows(suite, mpc, X, .false.)
      call check_curvature(suite, mpc, X)
    end do
  end subroutine test_rows


  !> Displacements that are not small.
  pure function some_displacement() result(u)
    real(DP) :: u(3, N_NODES)
    integer :: i
    u = 0.3_DP * reshape([(sin(real(3 * i, DP)), i=1, 3 * N_NODES)], [3, N_NODES])
  end function some_displacement


  !> d(-rhs)/du = the coefficients, by central differences.
  subroutine check_rows(suite, mpc, X, is_nlgeom)
    type(suite_type), intent(inout) :: suite
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: X(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: H = 1.0e-6_DP
    type(constraint_row_type), allocatable :: rows(:), plus(:), minus(:)
    real(DP) :: u(3, N_NODES), v(3, N_NODES), slope
    integer :: i, k
    character(24) :: name
    write (name, '(a,i0,l2)') 'row of mpc ', mpc%kind, is_nlgeom
    u = some_displacement()
    call evaluate_mpc_rows(mpc, X, u, is_nlgeom, rows)
    do i = 1, 3 * N_NODES
      v = u
      v(mod(i - 1, 3) + 1, (i + 2) / 3) = v(mod(i - 1, 3) + 1, (i + 2) / 3) + H
      call evaluate_mpc_rows(mpc, X, v, is_nlgeom, plus)
      v(mod(i - 1, 3) + 1, (i + 2) / 3) = v(mod(i - 1, 3) + 1, (i + 2) / 3) - 2.0_DP * H
      call evaluate_mpc_rows(mpc, X, v, is_nlgeom, minus)
      do k = 1, size(rows)
        slope = sum(rows(k)%coefficient, mask=rows(k)%unknown == i)
        call suite%near(name, slope, (minus(k)%rhs - plus(k)%rhs) / (2.0_DP * H), 1.0e-8_DP)
      end do
    end do
    u = 0.0_DP
    call evaluate_mpc_rows(mpc, X, u, is_nlgeom, rows)
    if (mpc%kind /= MPC_PLANE .and. mpc%kind /= MPC_STRAIGHT) call suite%near(name // ' at the start', &
      maxval([(abs(rows(k)%rhs), k=1, size(rows))]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_rows


  !> The second derivative is the weighted difference of the rows.
  subroutine check_curvature(suite, mpc, X)
    type(suite_type), intent(inout) :: suite
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: X(:, :)
    real(DP), parameter :: H = 1.0e-6_DP
    type(constraint_row_type), allocatable :: rows(:), plus(:), minus(:)
    real(DP), allocatable :: weight(:), curvature(:, :)
    integer, allocatable :: nodes(:)
    real(DP) :: u(3, N_NODES), v(3, N_NODES), slope
    integer :: i, j, k, unknown
    u = some_displacement()
    call evaluate_mpc_rows(mpc, X, u, .true., rows)
    weight = [(1.0_DP + 0.5_DP * real(k, DP), k=1, size(rows))]
    call evaluate_mpc_hessian(mpc, X, u, weight, curvature)
    nodes = list_hessian_nodes(mpc)
    do j = 1, 3 * size(nodes)
      v = u
      associate (moved => v(mod(j - 1, 3) + 1, nodes((j + 2) / 3)))
        moved = moved + H
        call evaluate_mpc_rows(mpc, X, v, .true., plus)
        moved = moved - 2.0_DP * H
        call evaluate_mpc_rows(mpc, X, v, .true., minus)
      end associate
      do i = 1, 3 * size(nodes)
        unknown = 3 * (nodes((i + 2) / 3) - 1) + mod(i - 1, 3) + 1
        slope = 0.0_DP
        do k = 1, size(rows)
          slope = slope + weight(k) * (sum(plus(k)%coefficient, mask=plus(k)%unknown == unknown) &
            - sum(minus(k)%coefficient, mask=minus(k)%unknown == unknown)) / (2.0_DP * H)
        end do
        call suite%near('curvature', curvature(i, j), slope, 1.0e-6_DP)
      end do
    end do
  end subroutine check_curvature


  !> The forces of chained rows balance the force on the dependent unknowns, and are spanned by the rows as given.
  subroutine test_multipliers(suite)
    type(suite_type), intent(inout) :: suite
    type(constraints_type) :: constraints
    type(constraint_row_type) :: row
    real(DP) :: force(3, 2), balance(6)
    real(DP), allocatable :: multiplier(:)
    integer :: verdict, k
    call reset_constraints(constraints, 6)
    call prescribe_unknown(constraints, 6, 0.25_DP)
    row%unknown = [1, 2, 3]
    row%coefficient = [1.0_DP, -2.0_DP, 0.5_DP]
    call add_constraint_row(constraints, row, 1, 0.0_DP, verdict)
    row%unknown = [2, 4, 1]
    row%coefficient = [3.0_DP, 1.0_DP, 1.0_DP]
    call add_constraint_row(constraints, row, 1, 0.0_DP, verdict)
    row%unknown = [4, 6, 2, 5]
    row%coefficient = [2.0_DP, 1.0_DP, 1.0_DP, -1.0_DP]
    call add_constraint_row(constraints, row, 1, 0.0_DP, verdict)
    call suite%that('three rows', verdict == ROW_ACCEPTED .and. constraints%n_rows == 3)
    call eliminate_constraints(constraints)
    force = reshape([1.0_DP, -2.0_DP, 3.0_DP, 0.5_DP, 4.0_DP, 7.0_DP], [3, 2])
    call find_multipliers(constraints, force, multiplier)
    balance = reshape(force, [6])
    do k = 1, 3
      associate (given => constraints%rows(k))
        balance(given%original_unknown) = balance(given%original_unknown) + multiplier(k) * given%original_coefficient
      end associate
    end do
    do k = 1, 3
      call suite%near('balance of a dependent unknown', balance(constraints%rows(k)%pivot), 0.0_DP, 1.0e-14_DP)
    end do
  end subroutine test_multipliers

end program test_nonlinear_mpc
