!> Integration rules of beams: points over the cross-section, at two places along the beam; extrapolation to the nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A beam is a hexahedron of 20 nodes around its cross-section. The points lie in the section alone, so that area, moments of
!! inertia and of torsion are those of the section:
!!
!! | section | points over it | exact |
!! |---|---|---|
!! | rectangle | 3 x 3 by Gauss | degree 5 in each direction |
!! | rectangle, circle with curved sides | 5 x 5 by Kronrod, from 2 by Gauss | degree 7 in each direction |
!! | pipe | 8 on the circle of the mean square radius | area, moments of inertia |
!! | box | 3 by Gauss on the middle of each wall | area, moments of inertia of the middle lines |
!! | circle | 4 and 8 on two circles | moments up to the degree 4 over the radius |
!!
!! Natural coordinates: xi along the beam, eta against direction 2, zeta along direction 1, each from -1 to 1 over the rectangle
!! around the section. Source of the pipe and of 5 x 5 points: CalculiX 2.20, beamintscheme.f, gauss.f; its box has five points of
!! Simpson's rule on each wall, with the same area and moments.
module amontons_beam_rules
  use amontons_kinds, only: DP, PI
  use amontons_element_kinds, only: KIND_BEAM_RECT, KIND_BEAM_PIPE, KIND_BEAM_BOX, KIND_BEAM_CIRC, KIND_BEAM_KRONROD, &
    MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  use amontons_tensor, only: solve_normal_equations
  implicit none
  private
  public :: is_beam_kind, set_beam_rule, extrapolate_beam, extrapolate_beam_trilinearly, interpolate_printed_points, &
    MAX_PRINTED_POINTS, GAUSS_2, GAUSS_3

  integer, parameter :: MAX_PRINTED_POINTS = 50    !< most points of a beam in tables of CalculiX
  integer, parameter :: MAX_SECTION_POINTS = 12    !< most points over a cross-section
  integer, parameter :: MAX_FUNCTIONS = 18         !< most functions of a fit
  real(DP), parameter :: GAUSS_2 = sqrt(3.0_DP) / 3, GAUSS_3 = sqrt(15.0_DP) / 5
  real(DP), parameter :: WEIGHTS_3(3) = [5.0_DP, 8.0_DP, 5.0_DP] / 9   !< of Gauss' rule of three points
  real(DP), parameter :: KRONROD = sqrt(6.0_DP / 7.0_DP)   !< outer points of the rule that extends that of two points to five
  real(DP), parameter :: KRONROD_LINE(5) = [-KRONROD, -GAUSS_2, 0.0_DP, GAUSS_2, KRONROD]
  real(DP), parameter :: KRONROD_WEIGHTS(5) = [98.0_DP / 495, 27.0_DP / 55, 28.0_DP / 45, 27.0_DP / 55, 98.0_DP / 495]

contains

  !> Whether a kind is the solid of a beam with a rule of its own.
  pure logical function is_beam_kind(kind)
    integer, intent(in) :: kind                    !< KIND_...
    is_beam_kind = kind >= KIND_BEAM_RECT .and. kind <= KIND_BEAM_KRONROD
  end function is_beam_kind


  !> The points and weights of a beam: those of the section behind, then in front; 5 x 5 points as CalculiX orders them. The weights
  !! add up to 8 times the part of the rectangle that the section fills.
  pure subroutine set_beam_rule(kind, walls, n, xi, w)
    integer, intent(in) :: kind                    !< KIND_BEAM_...
    real(DP), intent(in) :: walls(4)               !< thickness over the dimension: box at +1, +2, -1, -2; pipe the first [-]
    integer, intent(out) :: n                      !< points
    real(DP), intent(inout) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    real(DP) :: place(2, MAX_SECTION_POINTS), weight(MAX_SECTION_POINTS)
    integer :: m, k
    if (kind == KIND_BEAM_KRONROD) then
      call set_kronrod(n, xi, w)
      return
    end if
    select case (kind)
    case (KIND_BEAM_RECT)
      call set_rectangle(m, place, weight)
    case (KIND_BEAM_PIPE)
      call set_ring(8, 0.5_DP * (1 + (1 - 2 * walls(1))**2), 1 - (1 - 2 * walls(1))**2, place, weight)
      m = 8
    case (KIND_BEAM_BOX)
      call set_box(walls, m, place, weight)
    case default
      call set_ring(4, 0.5_DP * (1 - GAUSS_2), 0.5_DP, place, weight)
      call set_ring(8, 0.5_DP * (1 + GAUSS_2), 0.5_DP, place(:, 5:), weight(5:))
      m = 12
    end select
    n = 2 * m
    do k = 0, 1
      xi(1, k * m + 1:k * m + m) = real(2 * k - 1, DP) * GAUSS_2
      xi(2:, k * m + 1:k * m + m) = place(:, :m)
      w(k * m + 1:k * m + m) = weight(:m)
    end do
  end subroutine set_beam_rule


  !> Gauss' rule of three by three points, eta fastest.
  pure subroutine set_rectangle(m, place, weight)
    integer, intent(out) :: m
    real(DP), intent(out) :: place(:, :), weight(:)
    integer :: i, j
    m = 9
    do j = 1, 3
      do i = 1, 3
        place(:, 3 * j - 3 + i) = real([i - 2, j - 2], DP) * GAUSS_3
        weight(3 * j - 3 + i) = WEIGHTS_3(i) * WEIGHTS_3(j)
      end do
    end do
  end subroutine set_rectangle


  !> The rule of five points by Kronrod over the section, whose inner four are those of Gauss' rule of two, in CalculiX's order.
  pure subroutine set_kronrod(n, xi, w)
    integer, intent(out) :: n
    real(DP), intent(inout) :: xi(:, :), w(:)
    integer :: p
    n = MAX_PRINTED_POINTS
    xi(:, :n) = kronrod_places()
    do p = 1, n
      w(p) = product(KRONROD_WEIGHTS([minloc(abs(KRONROD_LINE - xi(2, p))), minloc(abs(KRONROD_LINE - xi(3, p)))]))
    end do
  end subroutine set_kronrod


  !> Equal points on a circle.
  pure subroutine set_ring(m, square, share, place, weight)
    integer, intent(in) :: m
    real(DP), intent(in) :: square                 !< of the radius [-]
    real(DP), intent(in) :: share                  !< of the area of the whole circle [-]
    real(DP), intent(inout) :: place(:, :), weight(:)
    integer :: i
    do i = 1, m
      associate (angle => 2 * PI * real(i - 1, DP) / real(m, DP))
        place(:, i) = sqrt(square) * [cos(angle), sin(angle)]
      end associate
      weight(i) = PI * share / real(m, DP)
    end do
  end subroutine set_ring


  !> Three points on the middle line of each wall, from the corner where the tables of CalculiX begin: along +1, +2, -1, -2.
  pure subroutine set_box(walls, m, place, weight)
    real(DP), intent(in) :: walls(4)
    integer, intent(out) :: m
    real(DP), intent(out) :: place(:, :), weight(:)
    real(DP) :: corner(2, 5)
    integer :: side, i
    m = 12
    corner = box_corners(walls)
    do side = 1, 4
      do i = 1, 3
        associate (s => 0.5_DP * (1 + real(i - 2, DP) * GAUSS_3), k => 3 * side - 3 + i)
          place(:, k) = (1 - s) * corner(:, side) + s * corner(:, side + 1)
          weight(k) = WEIGHTS_3(i) * walls(side) * norm2(corner(:, side + 1) - corner(:, side))
        end associate
      end do
    end do
  end subroutine set_box


  !> The ends of the middle lines of the walls, once round.
  pure function box_corners(walls) result(corner)
    real(DP), intent(in) :: walls(4)
    real(DP) :: corner(2, 5)
    associate (first => 1 - walls(1), second => walls(2) - 1, third => walls(3) - 1, fourth => 1 - walls(4))
      corner = reshape([fourth, first, second, first, second, third, fourth, third, fourth, first], [2, 5])
    end associate
  end function box_corners


  !> Extrapolation from the points to the nodes: linear along the beam; over the section quadratic of 3 x 3 and 5 x 5 points, else
  !! linear by least squares. Corners of pipes and circles show the edge of the section in their direction.
  pure subroutine extrapolate_beam(kind, walls, nodes, matrix)
    integer, intent(in) :: kind                    !< KIND_BEAM_...
    real(DP), intent(in) :: walls(4)
    real(DP), intent(in) :: nodes(:, :)            !< (3, 20) natural coordinates of the nodes
    real(DP), intent(out) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)   !< zero past the points [-]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), place(3, size(nodes, 2))
    integer :: n, a
    matrix = 0
    call set_beam_rule(kind, walls, n, xi, w)
    place = nodes
    if (kind == KIND_BEAM_PIPE .or. kind == KIND_BEAM_CIRC) then
      do a = 1, size(nodes, 2)
        place(2:, a) = place(2:, a) / max(1.0_DP, norm2(place(2:, a)))
      end do
    end if
    matrix(:size(nodes, 2), :n) = fit(kind, xi(:, :n), place)
  end subroutine extrapolate_beam


  !> Extrapolation from the points to the nodes as in CalculiX: trilinear through eight points, of mid-side nodes the mean of their
  !! corners.
  !!
  !! | section | eight points |
  !! |---|---|
  !! | 5 x 5 points | those of 2 x 2 x 2 by Gauss, which are the first |
  !! | pipe | the same; there the mean of the four diagonal points, and the difference to it by the ratio of the radii |
  !! | box | the corners of the middle lines of the walls |
  !!
  !! Corners of pipes are thus those of the rectangle around them, where there is no wall. Source: CalculiX 2.20, extrapolate.f,
  !! beamextscheme.f.
  pure subroutine extrapolate_beam_trilinearly(kind, walls, nodes, matrix)
    integer, intent(in) :: kind                    !< KIND_BEAM_PIPE, KIND_BEAM_BOX or KIND_BEAM_KRONROD
    real(DP), intent(in) :: walls(4)
    real(DP), intent(in) :: nodes(:, :)            !< (3, 20) natural coordinates of the nodes, from -1 to 1
    real(DP), intent(out) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)   !< zero past the points [-]
    real(DP) :: at_eight(8, MAX_ELEMENT_POINTS), xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), low(3), high(3), &
      from(MAX_PRINTED_POINTS, MAX_ELEMENT_POINTS), corner(2, 5), s(3), place(3), r
    integer :: n, m, a, k, i, c
    call set_beam_rule(kind, walls, n, xi, w)
    low = -GAUSS_2
    high = GAUSS_2
    at_eight = 0
    if (kind == KIND_BEAM_BOX) then
      corner = box_corners(walls)
      low(2:) = minval(corner, dim=2)
      high(2:) = maxval(corner, dim=2)
      call interpolate_printed_points(kind, m, from)
    end if
    do k = 0, 1
      do c = 1, 4                                  ! eta fastest
        i = 4 * k + c
        place = merge(low, high, [k, modulo(c - 1, 2), (c - 1) / 2] == 0)
        select case (kind)
        case (KIND_BEAM_KRONROD)                   ! its first eight points, xi fastest
          at_eight(i, 1 + k + 2 * (c - 1)) = 1
        case (KIND_BEAM_PIPE)
          r = sqrt(2.0_DP) * GAUSS_2 / norm2(xi(2:, 2))
          m = 8 * k + 2 * minloc([(norm2(xi(2:, 8 * k + 2 * a) / norm2(xi(2:, 2)) - place(2:) / norm2(place(2:))), a=1, 4)], dim=1)
          at_eight(i, 8 * k + 2:8 * k + 8:2) = 0.25_DP * (1 - r)
          at_eight(i, m) = at_eight(i, m) + r
        case (KIND_BEAM_BOX)
          m = 16 * k + 4 * minloc([(norm2(corner(:, a) - place(2:)), a=1, 4)], dim=1) - 3
          at_eight(i, :) = from(m, :)
        end select
      end do
    end do
    matrix = 0
    do a = 1, size(nodes, 2)
      do i = 1, 8
        r = 0
        do m = -1, 1, 2                            ! both ends of its edge, twice the corner itself
          place = nodes(:, a)
          where (.not. abs(place) > 0) place = real(m, DP)
          s = merge(high - place, place - low, [(i - 1) / 4, modulo(i - 1, 2), modulo((i - 1) / 2, 2)] == 0) / (high - low)
          r = r + 0.5_DP * product(s)
        end do
        matrix(a, :) = matrix(a, :) + r * at_eight(i, :)
      end do
    end do
  end subroutine extrapolate_beam_trilinearly


  !> From the points to those of CalculiX's tables; n = 0: the same points. A box: a parabola through the three points of a wall, at
  !! five places of it.
  pure subroutine interpolate_printed_points(kind, n, matrix)
    integer, intent(in) :: kind                    !< KIND_...
    integer, intent(out) :: n                      !< rows
    real(DP), intent(out) :: matrix(MAX_PRINTED_POINTS, MAX_ELEMENT_POINTS)   !< zero past n and the points [-]
    real(DP) :: s, r
    integer :: k, side, i
    n = 0
    matrix = 0
    if (kind /= KIND_BEAM_BOX) return
    n = 32
    do k = 0, 1
      do side = 1, 4
        do i = 0, 3
          s = 0.5_DP * real(i, DP) - 1
          r = s / GAUSS_3
          matrix(16 * k + 4 * side - 3 + i, 12 * k + 3 * side - 2:12 * k + 3 * side) = [0.5_DP * r * (r - 1), 1 - r**2, &
            0.5_DP * r * (r + 1)]
        end do
      end do
    end do
  end subroutine interpolate_printed_points


  !> Places of CalculiX's 50 points of a beam: those of 2 x 2 x 2, then at both places along it the rest of 5 x 5.
  pure function kronrod_places() result(place)
    real(DP) :: place(3, MAX_PRINTED_POINTS)
    integer :: n, i, j, k
    n = 0
    do k = 2, 4, 2
      do j = 2, 4, 2
        do i = 2, 4, 2
          n = n + 1
          place(:, n) = KRONROD_LINE([i, j, k])
        end do
      end do
    end do
    do i = 2, 4, 2
      do k = 1, 5
        do j = 1, 5
          if (modulo(j, 2) == 0 .and. modulo(k, 2) == 0) cycle
          n = n + 1
          place(:, n) = KRONROD_LINE([i, j, k])
        end do
      end do
    end do
  end function kronrod_places


  !> The matrix of a least squares fit: values at places from values at points.
  pure function fit(kind, points, places) result(matrix)
    integer, intent(in) :: kind                    !< KIND_BEAM_...
    real(DP), intent(in) :: points(:, :), places(:, :)   !< (3, n) natural coordinates
    real(DP) :: matrix(size(places, 2), size(points, 2))
    real(DP) :: at_points(MAX_FUNCTIONS, size(points, 2)), at_places(MAX_FUNCTIONS, size(places, 2))
    integer :: n, p
    n = merge(18, 6, kind == KIND_BEAM_RECT .or. kind == KIND_BEAM_KRONROD)
    do p = 1, size(points, 2)
      at_points(:, p) = fit_functions(points(:, p))
    end do
    do p = 1, size(places, 2)
      at_places(:, p) = fit_functions(places(:, p))
    end do
    call solve_normal_equations(at_points(:n, :))
    matrix = matmul(transpose(at_places(:n, :)), at_points(:n, :))
  end function fit


  !> Linear functions over the section times linear ones along the beam, then those of the second degree.
  pure function fit_functions(xi) result(value)
    real(DP), intent(in) :: xi(3)
    real(DP) :: value(MAX_FUNCTIONS), over(9)
    over(:3) = [1.0_DP, xi(2), xi(3)]
    over(4:) = [xi(2) * xi(3), xi(2)**2, xi(3)**2, xi(2)**2 * xi(3), xi(2) * xi(3)**2, (xi(2) * xi(3))**2]
    value = [over(:3), xi(1) * over(:3), over(4:), xi(1) * over(4:)]
  end function fit_functions

end module amontons_beam_rules
