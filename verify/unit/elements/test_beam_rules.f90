!> Unit test of beam_rules: area, moments, extrapolation and tables of each cross-section.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_beam_rules
  use amontons_beam_rules, only: is_beam_kind, set_beam_rule, extrapolate_beam, extrapolate_beam_trilinearly, &
    interpolate_printed_points, MAX_PRINTED_POINTS
  use amontons_kinds, only: DP, PI
  use amontons_shape_functions, only: node_coordinates
  use amontons_element_kinds, only: KIND_BEAM_RECT, KIND_BEAM_PIPE, KIND_BEAM_BOX, KIND_BEAM_CIRC, KIND_BEAM_KRONROD, &
    KIND_C3D20, KIND_CPS3, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: NONE(4) = 0
  real(DP), parameter :: HOLE = 0.6_DP             ! inner over outer radius of the pipe
  logical, parameter :: IS_ALONG_ETA(4) = [.true., .false., .true., .false.]   ! walls at +1 and -1
  real(DP), parameter :: WALLS(4) = [0.1_DP, 0.2_DP, 0.05_DP, 0.3_DP]
  call suite%that('kinds', is_beam_kind(KIND_BEAM_RECT) .and. is_beam_kind(KIND_BEAM_KRONROD) .and. .not. is_beam_kind(KIND_C3D20) &
    .and. .not. is_beam_kind(KIND_CPS3))
  call check_moments('rectangle', KIND_BEAM_RECT, NONE, [4.0_DP, 4.0_DP / 3, 4.0_DP / 3], 18)
  call check_moments('Kronrod', KIND_BEAM_KRONROD, NONE, [4.0_DP, 4.0_DP / 3, 4.0_DP / 3], 50)
  call check_moments('circle', KIND_BEAM_CIRC, NONE, [PI, PI / 4, PI / 4], 24)
  call check_moments('pipe', KIND_BEAM_PIPE, [0.5_DP * (1 - HOLE), 0.0_DP, 0.0_DP, 0.0_DP], [PI * (1 - HOLE**2), &
    PI * (1 - HOLE**4) / 4, PI * (1 - HOLE**4) / 4], 16)
  call check_box()
  call check_fourth_moment()
  call check_extrapolation()
  call check_trilinear()
  call check_tables()
  call suite%finish()

contains

  !> Area and second moments over the section, and the number of points; along the beam 1 and xi^2 are exact.
  subroutine check_moments(name, kind, walls, expected, n_expected)
    character(*), intent(in) :: name
    integer, intent(in) :: kind, n_expected
    real(DP), intent(in) :: walls(4), expected(3)
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    integer :: n
    xi = 0
    w = 0
    call set_beam_rule(kind, walls, n, xi, w)
    call suite%that(name // ': points', n == n_expected)
    call suite%near(name // ': area', sum(w) / 2, expected(1), 1.0e-14_DP)
    call suite%near(name // ': eta^2', sum(w * xi(2, :)**2) / 2, expected(2), 1.0e-14_DP)
    call suite%near(name // ': zeta^2', sum(w * xi(3, :)**2) / 2, expected(3), 1.0e-14_DP)
    call suite%near(name // ': xi^2', sum(w * xi(1, :)**2), 2 * expected(1) / 3, 1.0e-14_DP)
    call suite%near(name // ': product', sum(w * xi(2, :) * xi(3, :)), 0.0_DP, 1.0e-14_DP)
  end subroutine check_moments


  !> The walls of a box: each on its side, with its area; moments of straight lines.
  subroutine check_box()
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), line(2, 4), place(4)
    integer :: n
    xi = 0
    w = 0
    call set_beam_rule(KIND_BEAM_BOX, WALLS, n, xi, w)
    line(:, 1) = [WALLS(2) - 1, 1 - WALLS(4)]      ! from and to: eta of the walls along direction 2, zeta of the others
    line(:, 3) = line(:, 1)
    line(:, 2) = [WALLS(3) - 1, 1 - WALLS(1)]
    line(:, 4) = line(:, 2)
    place = [1 - WALLS(1), WALLS(2) - 1, WALLS(3) - 1, 1 - WALLS(4)]
    associate (area => 2 * WALLS * (line(2, :) - line(1, :)), middle => 0.5_DP * (line(1, :) + line(2, :)))
      call suite%that('box: points', n == 24)
      call suite%near('box: area', sum(w) / 2, sum(area), 1.0e-14_DP)
      call suite%near('box: zeta', sum(w * xi(3, :)) / 2, sum(area * merge(place, middle, IS_ALONG_ETA)), 1.0e-14_DP)
      call suite%near('box: eta', sum(w * xi(2, :)) / 2, sum(area * merge(middle, place, IS_ALONG_ETA)), 1.0e-14_DP)
      call suite%near('box: eta^2', sum(w * xi(2, :)**2) / 2, sum(area * merge(middle**2 + (line(2, :) - line(1, :))**2 / 12, &
        place**2, IS_ALONG_ETA)), 1.0e-14_DP)
    end associate
  end subroutine check_box


  !> Two circles integrate r^4 and r^6 of the full circle exactly, five points by Kronrod the power 6 in each direction.
  subroutine check_fourth_moment()
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    integer :: n
    xi = 0
    w = 0
    call set_beam_rule(KIND_BEAM_CIRC, NONE, n, xi, w)
    associate (square => xi(2, :)**2 + xi(3, :)**2)
      call suite%near('circle: r^4', sum(w * square**2) / 2, PI / 3, 1.0e-14_DP)
      call suite%near('circle: r^6', sum(w * square**3) / 2, PI / 4, 1.0e-14_DP)
    end associate
    xi = 0
    w = 0
    call set_beam_rule(KIND_BEAM_KRONROD, NONE, n, xi, w)
    call suite%near('Kronrod: eta^6 zeta^6', sum(w * (xi(2, :) * xi(3, :))**6) / 2, 4.0_DP / 49, 1.0e-14_DP)
  end subroutine check_fourth_moment


  !> A linear field comes back at the nodes, beyond the edge of pipes too; so does a product of two coordinates with 5 x 5 points.
  subroutine check_trilinear()
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), nodes(3, MAX_ELEMENT_NODES), matrix(MAX_ELEMENT_NODES, &
      MAX_ELEMENT_POINTS), values(MAX_ELEMENT_POINTS)
    integer :: kind, n, a
    call node_coordinates(KIND_C3D20, nodes)
    do kind = KIND_BEAM_PIPE, KIND_BEAM_KRONROD
      if (kind == KIND_BEAM_CIRC) cycle
      xi = 0
      w = 0
      call set_beam_rule(kind, WALLS, n, xi, w)
      call extrapolate_beam_trilinearly(kind, WALLS, nodes, matrix)
      values = 1 + 2 * xi(2, :) - 3 * xi(3, :) + xi(1, :) * (0.5_DP + xi(2, :))
      if (kind == KIND_BEAM_KRONROD) values = values + xi(2, :) * xi(3, :)
      do a = 1, 20
        associate (place => nodes(:, a), twist => merge(product(nodes(2:, a)), 0.0_DP, kind == KIND_BEAM_KRONROD))
          call suite%near('trilinear', dot_product(matrix(a, :n), values(:n)), 1 + 2 * place(2) - 3 * place(3) + place(1) * &
            (0.5_DP + place(2)) + twist, 2.0e-13_DP)
        end associate
      end do
    end do
  end subroutine check_trilinear


  !> A linear field comes back at the nodes; of circles at the edge of the section. 3 x 3 and 5 x 5 points return
  !! quadratic fields.
  subroutine check_extrapolation()
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), nodes(3, MAX_ELEMENT_NODES), matrix(MAX_ELEMENT_NODES, &
      MAX_ELEMENT_POINTS), place(3), values(MAX_ELEMENT_POINTS)
    integer :: kind, n, a
    call node_coordinates(KIND_C3D20, nodes)
    do kind = KIND_BEAM_RECT, KIND_BEAM_KRONROD
      xi = 0
      w = 0
      call set_beam_rule(kind, WALLS, n, xi, w)
      call extrapolate_beam(kind, WALLS, nodes, matrix)
      values = 1 + 2 * xi(2, :) - 3 * xi(3, :) + xi(1, :) * (0.5_DP + xi(2, :))
      if (is_square(kind)) values = values + xi(2, :)**2 * xi(3, :)
      do a = 1, 20
        place = nodes(:, a)
        if (kind == KIND_BEAM_PIPE .or. kind == KIND_BEAM_CIRC) place(2:) = place(2:) / max(1.0_DP, norm2(place(2:)))
        associate (expected => 1 + 2 * place(2) - 3 * place(3) + place(1) * (0.5_DP + place(2)))
          call suite%near('extrapolation', dot_product(matrix(a, :n), values(:n)), expected + merge(place(2)**2 * place(3), &
            0.0_DP, is_square(kind)), 2.0e-13_DP)
        end associate
      end do
    end do
  end subroutine check_extrapolation


  !> Whether the points of a kind are those of a square in rows and columns.
  pure logical function is_square(kind)
    integer, intent(in) :: kind
    is_square = kind == KIND_BEAM_RECT .or. kind == KIND_BEAM_KRONROD
  end function is_square


  !> The rows of CalculiX: corners and middles of the walls of a box; pipes and 5 x 5 points have their own, in its order.
  subroutine check_tables()
    real(DP) :: matrix(MAX_PRINTED_POINTS, MAX_ELEMENT_POINTS), xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    integer :: n, m
    call interpolate_printed_points(KIND_BEAM_PIPE, n, matrix)
    call suite%that('pipe: its own points', n == 0)
    call interpolate_printed_points(KIND_BEAM_KRONROD, n, matrix)
    xi = 0
    w = 0
    call set_beam_rule(KIND_BEAM_KRONROD, NONE, m, xi, w)
    call suite%that('Kronrod: its own points', n == 0)
    call suite%near('Kronrod: row 1', norm2(xi(:, 1) + sqrt(1 / 3.0_DP)), 0.0_DP, 1.0e-13_DP)
    call suite%near('Kronrod: row 2', norm2(xi(:, 2) - [real(DP) :: 1, -1, -1] * sqrt(1 / 3.0_DP)), 0.0_DP, 1.0e-13_DP)
    call suite%near('Kronrod: row 9', norm2(xi(:, 9) + [sqrt(1 / 3.0_DP), sqrt(6 / 7.0_DP), sqrt(6 / 7.0_DP)]), 0.0_DP, 1.0e-13_DP)
    call suite%near('Kronrod: row 50', norm2(xi(:, 50) - [sqrt(1 / 3.0_DP), sqrt(6 / 7.0_DP), sqrt(6 / 7.0_DP)]), 0.0_DP, &
      1.0e-13_DP)
    call interpolate_printed_points(KIND_BEAM_BOX, n, matrix)
    xi = 0
    call set_beam_rule(KIND_BEAM_BOX, WALLS, m, xi, w)
    call suite%that('box: rows', n == 32)
    call suite%near('box: first corner', norm2(matmul(matrix(1, :), transpose(xi)) - [-sqrt(1 / 3.0_DP), 1 - WALLS(4), &
      1 - WALLS(1)]), 0.0_DP, 1.0e-14_DP)
    call suite%near('box: middle of the last wall', norm2(matmul(matrix(31, :), transpose(xi)) - [sqrt(1 / 3.0_DP), 1 - WALLS(4), &
      0.5_DP * (WALLS(3) - WALLS(1))]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_tables

end program test_beam_rules
