!> Unit test of amontons_face_foundation: forces of a uniform displacement, of a turned face, and stiffness by differences.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_face_foundation
  use amontons_kinds, only: DP, PI
  use amontons_element_kinds, only: FACET_TRI3, FACET_TRI6, FACET_QUAD4, FACET_QUAD8, FACET_LINE2, FACET_LINE3, &
    MAX_FACE_NODES
  use amontons_face_foundation, only: integrate_face_foundation, integrate_edge_foundation
  use check, only: suite_type
  implicit none
  real(DP), parameter :: K = 3.0_DP
  integer, parameter :: FACETS(4) = [FACET_TRI3, FACET_TRI6, FACET_QUAD4, FACET_QUAD8]
  integer, parameter :: N_NODES(4) = [3, 6, 4, 8]
  real(DP), parameter :: SQUARE(3, 8) = reshape([real(DP) :: 0, 0, 0, 2, 0, 0, 2, 3, 0, 0, 3, 0, 1, 0, 0, 2, 1.5_DP, 0, &
    1, 3, 0, 0, 1.5_DP, 0], [3, 8])
  real(DP), parameter :: TRIANGLE(3, 6) = reshape([real(DP) :: 0, 0, 0, 4, 0, 0, 0, 3, 0, 2, 0, 0, 2, 1.5_DP, 0, &
    0, 1.5_DP, 0], [3, 6])
  type(suite_type) :: suite
  integer :: i, n
  call random_seed(size=n)
  call random_seed(put=[(32452843 + 7919 * i, i=1, n)])
  do i = 1, 4
    call check_uniform(i)
    call check_turned(i)
    call check_derivative(i, .false.)
    call check_derivative(i, .true.)
  end do
  do i = 2, 3
    call check_edge(.false., i)
    call check_edge(.true., i)
  end do
  call suite%finish()

contains

  !> Nodes of a face of area 6 in the plane z = 0.
  function face(i) result(X)
    integer, intent(in) :: i                       !< index into FACETS
    real(DP) :: X(3, N_NODES(i))
    if (i <= 2) then
      X = TRIANGLE(:, :N_NODES(i))
    else
      X = SQUARE(:, :N_NODES(i))
    end if
  end function face


  !> A displacement (1, 2, 0.5) has the normal part 0.5: the force is -k 0.5 times the area along z.
  subroutine check_uniform(i)
    integer, intent(in) :: i
    real(DP) :: u(3, N_NODES(i)), force(3, MAX_FACE_NODES), stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)
    u = spread([1.0_DP, 2.0_DP, 0.5_DP], 2, N_NODES(i))
    call integrate_face_foundation(FACETS(i), face(i), u, K, .false., force, stiffness)
    call suite%near('force', norm2(sum(force, dim=2) - [0.0_DP, 0.0_DP, -0.5_DP * 6 * K]), 0.0_DP, 1.0e-12_DP)
    call integrate_face_foundation(FACETS(i), face(i), u, K, .true., force, stiffness)
    call suite%near('of a moved face', norm2(sum(force, dim=2) - [0.0_DP, 0.0_DP, -0.5_DP * 6 * K]), 0.0_DP, 1.0e-12_DP)
  end subroutine check_uniform


  !> A face that has turned by 90 degrees about y and moved by d along its new normal x, which the displacement of its points in the
  !! mean has along it, too: -k (u . n) n A with u of the centroid.
  subroutine check_turned(i)
    integer, intent(in) :: i
    real(DP) :: u(3, N_NODES(i)), X(3, N_NODES(i)), force(3, MAX_FACE_NODES), stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)
    real(DP), parameter :: WAY = 0.3_DP
    real(DP) :: centroid
    integer :: a
    X = face(i)
    do a = 1, N_NODES(i)
      u(:, a) = [WAY, X(2, a), -X(1, a)] - X(:, a)
    end do
    centroid = merge(4 / 3.0_DP, 1.0_DP, i <= 2)   ! u along x is WAY - x
    call integrate_face_foundation(FACETS(i), X, u, K, .true., force, stiffness)
    call suite%near('turned', norm2(sum(force, dim=2) - [-(WAY - centroid) * 6 * K, 0.0_DP, 0.0_DP]), 0.0_DP, 1.0e-11_DP)
  end subroutine check_turned


  !> The stiffness against differences; at small displacements it is symmetric and the force linear.
  subroutine check_derivative(i, is_nlgeom)
    integer, intent(in) :: i
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: STEP = 1.0e-6_DP
    real(DP) :: X(3, N_NODES(i)), u(3, N_NODES(i)), moved(3, N_NODES(i)), noise(3, N_NODES(i))
    real(DP) :: force(3, MAX_FACE_NODES), plus(3, MAX_FACE_NODES), minus(3, MAX_FACE_NODES)
    real(DP) :: stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES), other(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)
    real(DP) :: difference(3 * MAX_FACE_NODES)
    integer :: a, c
    call random_number(noise)
    X = face(i) + 0.3_DP * noise
    call random_number(u)
    call integrate_face_foundation(FACETS(i), X, u, K, is_nlgeom, force, stiffness)
    do a = 1, N_NODES(i)
      do c = 1, 3
        moved = u
        moved(c, a) = u(c, a) + STEP
        call integrate_face_foundation(FACETS(i), X, moved, K, is_nlgeom, plus, other)
        moved(c, a) = u(c, a) - STEP
        call integrate_face_foundation(FACETS(i), X, moved, K, is_nlgeom, minus, other)
        difference = reshape((plus - minus) / (2 * STEP), [3 * MAX_FACE_NODES])
        call suite%near('stiffness', maxval(abs(difference - stiffness(:, 3 * a - 3 + c))), 0.0_DP, 1.0e-8_DP * K)
      end do
    end do
    if (is_nlgeom) return
    call suite%near('symmetric', maxval(abs(stiffness - transpose(stiffness))), 0.0_DP, 1.0e-12_DP)
    associate (m => 3 * N_NODES(i))
      call suite%near('linear', maxval(abs(matmul(stiffness(:m, :m), reshape(u, [m])) - reshape(force(:, :N_NODES(i)), [m]))), &
        0.0_DP, 1.0e-12_DP)
    end associate
  end subroutine check_derivative


  !> An edge of length 2 along x at y = 0: force and derivative.
  subroutine check_edge(is_round, n)
    logical, intent(in) :: is_round                !< of a body of revolution
    integer, intent(in) :: n                       !< nodes
    real(DP), parameter :: STEP = 1.0e-6_DP
    real(DP) :: X(3, n), u(3, n), moved(3, n), force(3, MAX_FACE_NODES), plus(3, MAX_FACE_NODES), minus(3, MAX_FACE_NODES)
    real(DP) :: stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES), other(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES), depth, width
    integer :: a, c, edge
    edge = merge(FACET_LINE2, FACET_LINE3, n == 2)
    X = 0
    X(1, :2) = [1.0_DP, 3.0_DP]
    if (n == 3) X(1, 3) = 2
    u = spread([0.2_DP, -0.5_DP, 0.0_DP], 2, n)
    width = merge(-1.0_DP, 0.7_DP, is_round)
    depth = merge(2 * PI * 2, 0.7_DP, is_round)
    call integrate_edge_foundation(edge, X, u, width, K, .false., force, stiffness)
    call suite%near('edge', norm2(sum(force, dim=2) - [0.0_DP, 0.5_DP * 2 * depth * K, 0.0_DP]), 0.0_DP, 1.0e-12_DP)
    call random_number(u)
    u(3, :) = 0
    call integrate_edge_foundation(edge, X, u, width, K, .true., force, stiffness)
    do a = 1, n
      do c = 1, 2
        moved = u
        moved(c, a) = u(c, a) + STEP
        call integrate_edge_foundation(edge, X, moved, width, K, .true., plus, other)
        moved(c, a) = u(c, a) - STEP
        call integrate_edge_foundation(edge, X, moved, width, K, .true., minus, other)
        call suite%near('stiffness of an edge', maxval(abs(reshape((plus - minus) / (2 * STEP), [3 * MAX_FACE_NODES]) - &
          stiffness(:, 3 * a - 3 + c))), 0.0_DP, 1.0e-7_DP * K)
      end do
    end do
  end subroutine check_edge

end program test_face_foundation
