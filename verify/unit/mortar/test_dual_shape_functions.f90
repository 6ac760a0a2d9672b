!> Unit test of amontons_dual_shape_functions: transformed bases, nodal integrals, biorthogonality on whole and cut facets.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_dual_shape_functions
  use amontons_dual_shape_functions, only: is_transformed, find_full_dual_fraction, transform_shape_functions, &
    transform_nodal_positions, nodal_integral_fractions, evaluate_dual_functions, BASIS_ALPHA
  use amontons_kinds, only: DP
  use amontons_polygon_clipping, only: set_polygon_quadrature, MAX_CUT_POINTS
  use amontons_shape_functions, only: facet_shapes, facet_node_coordinates
  use amontons_element_kinds, only: facet_kind, facet_kind_type, MAX_FACE_NODES, FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, &
    FACET_LINE2, FACET_LINE3
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: kind
  call suite%that('quadratic faces are transformed, lines are not', all(is_transformed([FACET_TRI3, FACET_QUAD4, FACET_TRI6, &
    FACET_QUAD8, FACET_LINE2, FACET_LINE3]) .eqv. [.false., .false., .true., .true., .false., .false.]))
  call check_fraction()
  do kind = FACET_TRI3, FACET_QUAD8
    call check_basis(kind)
    call check_duals(kind, 1.0_DP)
    call check_duals(kind, 0.7_DP)
    call check_sliver(kind)
  end do
  call check_lines()
  call suite%finish()

contains

  !> The fraction runs from 0 to 1 without a jump, and its slope is that of differences.
  subroutine check_fraction()
    real(DP) :: fraction, slope, before, after, unused, cover
    integer :: kind, i
    real(DP), parameter :: STEP = 1.0e-6_DP
    do kind = FACET_TRI3, FACET_LINE3
      call find_full_dual_fraction(kind, 1.0_DP, fraction, slope)
      call suite%that('all of a whole facet', fraction == 1 .and. slope == 0)
      do i = 1, 60
        cover = 0.01_DP * real(i, DP) + 0.003_DP
        call find_full_dual_fraction(kind, cover, fraction, slope)
        call find_full_dual_fraction(kind, cover - STEP, before, unused)
        call find_full_dual_fraction(kind, cover + STEP, after, unused)
        call suite%that('between 0 and 1, never falling', fraction >= 0 .and. fraction <= 1 .and. after >= before)
        call suite%near('slope', slope, (after - before) / (2 * STEP), 1.0e-6_DP * (1 + slope))
      end do
    end do
    call find_full_dual_fraction(FACET_QUAD8, 0.02_DP, fraction, slope)
    call suite%that('nothing of a sliver', fraction == 0 .and. slope == 0)
  end subroutine check_fraction


  !> The natural coordinates of the corners, and points and weights over the part of them with xi_1 below a share.
  subroutine make_points(kind, part, n, point, weight, area)
    integer, intent(in) :: kind
    real(DP), intent(in) :: part                   !< of the first coordinate's range [-]
    integer, intent(out) :: n
    real(DP), intent(out) :: point(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS)
    real(DP), intent(out) :: area                  !< of the whole facet
    type(facet_kind_type) :: shape
    shape = facet_kind(kind)
    if (shape%n_corners == 3) then
      area = 0.5_DP
      call set_polygon_quadrature(reshape([0.0_DP, 0.0_DP, part, 0.0_DP, part, 1 - part, 0.0_DP, 1.0_DP], [2, 4]), .false., 5, &
        n, point, weight)
    else
      area = 4
      call set_polygon_quadrature(reshape([-1.0_DP, -1.0_DP, 2 * part - 1, -1.0_DP, 2 * part - 1, 1.0_DP, -1.0_DP, 1.0_DP], &
        [2, 4]), .false., 5, n, point, weight)
    end if
  end subroutine make_points


  !> Transformed functions add up to 1, reproduce the place with the transformed nodes, and have the integrals of the table.
  subroutine check_basis(kind)
    integer, intent(in) :: kind
    type(facet_kind_type) :: shape
    real(DP) :: point(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS), area, nodes(2, MAX_FACE_NODES), N(MAX_FACE_NODES)
    real(DP) :: dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), total(MAX_FACE_NODES), fractions(MAX_FACE_NODES)
    integer :: q, n_points
    shape = facet_kind(kind)
    call make_points(kind, 1.0_DP, n_points, point, weight, area)
    call facet_node_coordinates(kind, nodes)
    call transform_nodal_positions(kind, nodes(:, :shape%n_nodes))
    total = 0
    do q = 1, n_points
      call facet_shapes(kind, point(:, q), N, dN, ddN)
      call transform_shape_functions(kind, N)
      associate (m => shape%n_nodes)
        call suite%near('they add up to 1', sum(N(:m)), 1.0_DP, 1.0e-14_DP)
        call suite%near('the place', norm2(matmul(nodes(:, :m), N(:m)) - point(:, q)), 0.0_DP, 1.0e-14_DP)
        total(:m) = total(:m) + weight(q) * N(:m) / area
      end associate
    end do
    fractions = nodal_integral_fractions(kind)
    call suite%near('integrals', norm2(total(:shape%n_nodes) - fractions(:shape%n_nodes)), 0.0_DP, 1.0e-14_DP)
    call suite%that('all positive', all(fractions(:shape%n_nodes) > 0) .and. sum(abs(fractions(shape%n_nodes + 1:))) <= 0)
    call suite%that('alpha makes them so', BASIS_ALPHA > 0.125_DP .and. BASIS_ALPHA < 0.5_DP)
  end subroutine check_basis


  !> phi_j and N~_k are biorthogonal over the part that is covered, and all phi add up to 1.
  subroutine check_duals(kind, part)
    integer, intent(in) :: kind
    real(DP), intent(in) :: part
    type(facet_kind_type) :: shape
    real(DP) :: point(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS), area, nodes(2, MAX_FACE_NODES)
    real(DP) :: shapes(MAX_FACE_NODES, MAX_CUT_POINTS), phi(MAX_FACE_NODES, MAX_CUT_POINTS), d(MAX_FACE_NODES), expected
    integer :: i, j, n_points
    shape = facet_kind(kind)
    call make_points(kind, part, n_points, point, weight, area)
    call evaluate(kind, area, n_points, point, weight, nodes, shapes, phi, d)
    associate (m => shape%n_nodes, n => n_points)
      call suite%near('d is the covered area', sum(d(:m)), sum(weight(:n)), 1.0e-14_DP)
      do i = 1, m
        do j = 1, m
          expected = merge(d(i), 0.0_DP, i == j)
          call suite%near('biorthogonal', sum(weight(:n) * phi(i, :n) * shapes(j, :n)), expected, 1.0e-12_DP)
        end do
      end do
      call suite%near('duals add up to 1', maxval(abs(sum(phi(:m, :n), 1) - 1)), 0.0_DP, 1.0e-11_DP)
    end associate
  end subroutine check_duals


  !> On a sliver they are dual to linear functions only: a linear field is taken over exactly, nothing blows up.
  subroutine check_sliver(kind)
    integer, intent(in) :: kind
    type(facet_kind_type) :: shape
    real(DP) :: point(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS), area, nodes(2, MAX_FACE_NODES)
    real(DP) :: shapes(MAX_FACE_NODES, MAX_CUT_POINTS), phi(MAX_FACE_NODES, MAX_CUT_POINTS), d(MAX_FACE_NODES), field
    integer :: i, n_points
    if (kind == FACET_TRI3) return                 ! its full duals are those of linear functions
    shape = facet_kind(kind)
    call make_points(kind, 0.02_DP, n_points, point, weight, area)
    call evaluate(kind, area, n_points, point, weight, nodes, shapes, phi, d)
    associate (m => shape%n_nodes, n => n_points)
      do i = 1, m
        field = sum(weight(:n) * phi(i, :n) * (1 + 2 * point(1, :n) - point(2, :n)))
        call suite%near('sliver: a linear field', field, d(i) * (1 + 2 * nodes(1, i) - nodes(2, i)), 1.0e-11_DP)
      end do
      call suite%near('sliver: they add up to 1', maxval(abs(sum(phi(:m, :n), 1) - 1)), 0.0_DP, 1.0e-9_DP)
    end associate
  end subroutine check_sliver


  !> The functions at the points, and the duals.
  subroutine evaluate(kind, area, n_points, point, weight, nodes, shapes, phi, d)
    integer, intent(in) :: kind, n_points
    real(DP), intent(in) :: area, point(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS)
    real(DP), intent(out) :: nodes(2, MAX_FACE_NODES), shapes(MAX_FACE_NODES, MAX_CUT_POINTS)
    real(DP), intent(out) :: phi(MAX_FACE_NODES, MAX_CUT_POINTS), d(MAX_FACE_NODES)
    type(facet_kind_type) :: shape
    real(DP) :: dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: q
    shape = facet_kind(kind)
    call facet_node_coordinates(kind, nodes)
    call transform_nodal_positions(kind, nodes(:, :shape%n_nodes))
    do q = 1, n_points
      call facet_shapes(kind, point(:, q), shapes(:, q), dN, ddN)
      call transform_shape_functions(kind, shapes(:, q))
    end do
    associate (m => shape%n_nodes, n => n_points)
      call evaluate_dual_functions(kind, area, nodes(:, :m), weight(:n), point(:, :n), shapes(:m, :n), phi(:m, :n), d(:m))
    end associate
  end subroutine evaluate


  !> Lines keep their functions; Simpson's shares.
  subroutine check_lines()
    real(DP) :: N(MAX_FACE_NODES), fractions(MAX_FACE_NODES)
    N = 0.25_DP
    call transform_shape_functions(FACET_LINE3, N)
    call suite%that('a line is not transformed', all(N == 0.25_DP))
    fractions = nodal_integral_fractions(FACET_LINE3)
    call suite%near('Simpson', norm2(fractions(:3) - [1.0_DP, 1.0_DP, 4.0_DP] / 6), 0.0_DP, 1.0e-15_DP)
    fractions = nodal_integral_fractions(FACET_LINE2)
    call suite%near('halves', norm2(fractions(:2) - 0.5_DP), 0.0_DP, 0.0_DP)
  end subroutine check_lines

end program test_dual_shape_functions
