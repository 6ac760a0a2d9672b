!> Cross-sections of beams: area, centroid, moments of inertia, torsion constant and shear centre by their dimensions.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Walls of I, T and L are rectangles, those of an arbitrary section lines of its thickness. Open sections have the torsion
!! constant sum b t^3/3, cells that of Bredt (S. Timoshenko, J. Goodier, Theory of Elasticity), a trapezoid that of Saint-Venant
!! by the method of Ritz. The shear centre is that of the middle lines of thin walls, by the warping function that has no
!! moment with the coordinates (V. Z. Vlasov, Thin-Walled Elastic Beams, 1961, chapter I). Shear factors are those of Abaqus
!! (Analysis User's Guide, Choosing a beam cross-section). Theory: doc/theory/elements.md, section "Beams by their section".
module amontons_beam_cross_sections
  use amontons_kinds, only: DP, PI
  use amontons_dense, only: solve_small
  implicit none
  private
  public :: cross_section_type, i_section, box_section, l_section, hexagon_section, trapezoid_section, wall_section
  public :: WALLS_OK, WALLS_LOOSE, WALLS_CELLS, WALLS_LINE

  integer, parameter :: WALLS_OK = 0
  integer, parameter :: WALLS_LOOSE = 1            !< a wall of thickness 0 that does not go back along another
  integer, parameter :: WALLS_CELLS = 2            !< several cells, or a cell with fins
  integer, parameter :: WALLS_LINE = 3             !< all walls on one line: no bending stiffness about it

  integer, parameter :: N_ACROSS = 7, N_ALONG = 14   !< functions of Ritz's method: even ones along axis 1, all along axis 2
  integer, parameter :: N_GAUSS = 24               !< points along each direction [-]

  !> The numbers of a cross-section.
  type :: cross_section_type
    real(DP) :: area = 1                           !< [length^2]
    real(DP) :: about(2) = 1, product = 0          !< second moments about axes 1, 2, product of inertia, all central [length^4]
    real(DP) :: torsion = 1                        !< J [length^4]
    real(DP) :: shear_factor = 1                   !< k [-]
    real(DP) :: centroid(2) = 0                    !< from the node along axes 1, 2 [length]
    real(DP) :: shear_center(2) = 0                !< from the node along axes 1, 2 [length]
  end type cross_section_type

contains

  !> An I, or a T if a flange has no width: web along axis 2.
  pure function i_section(node, height, width, thickness, web) result(section)
    real(DP), intent(in) :: node                   !< its height over the bottom [length]
    real(DP), intent(in) :: height, width(2), thickness(2)   !< of the section; of the lower and the upper flange [length]
    real(DP), intent(in) :: web                    !< its thickness [length]
    type(cross_section_type) :: section
    real(DP) :: middle(3)                          ! heights of both flanges and of the web
    middle = [thickness(1) / 2, height - thickness(2) / 2, (height + thickness(1) - thickness(2)) / 2] - node
    section = rectangles(reshape([0.0_DP, middle(1), 0.0_DP, middle(2), 0.0_DP, middle(3)], [2, 3]), &
      reshape([width(1), thickness(1), width(2), thickness(2), web, height - sum(thickness)], [2, 3]))
    section%torsion = (sum(width * thickness**3) + (height - sum(thickness)) * web**3) / 3
    section%shear_factor = 0.44_DP
    section%shear_center = shear_center(reshape([-width(1) / 2, middle(1), width(1) / 2, middle(1), 0.0_DP, middle(1), &
      0.0_DP, middle(2), -width(2) / 2, middle(2), width(2) / 2, middle(2)], [2, 6]), &
      [thickness(1), 0.0_DP, web, 0.0_DP, thickness(2)])
  end function i_section


  !> A box; its node is at the middle of the outer rectangle.
  pure function box_section(outside, plus, minus) result(section)
    real(DP), intent(in) :: outside(2)             !< dimensions along axes 1, 2 [length]
    real(DP), intent(in) :: plus(2), minus(2)      !< thickness of the walls at +1, +2 and at -1, -2 [length]
    type(cross_section_type) :: section
    real(DP) :: inner(2), line(2), low(2), high(2)
    inner = outside - plus - minus
    section = rectangles(reshape([0.0_DP, 0.0_DP, 0.5_DP * (minus - plus)], [2, 2]), reshape([outside, inner], [2, 2]), &
      [1.0_DP, -1.0_DP])
    line = outside - 0.5_DP * (plus + minus)        ! middle lines of the walls
    section%torsion = 4 * product(line)**2 / (line(2) / plus(1) + line(1) / plus(2) + line(2) / minus(1) + line(1) / minus(2))
    section%shear_factor = 0.44_DP
    low = 0.5_DP * (minus - outside)
    high = 0.5_DP * (outside - plus)
    section%shear_center = shear_center(reshape([low, high(1), low(2), high, low(1), high(2), low], [2, 5]), &
      [minus(2), plus(1), plus(2), minus(1)])
  end function box_section


  !> An L with legs along +1 and +2; its node is where their middle lines meet.
  pure function l_section(length, thickness) result(section)
    real(DP), intent(in) :: length(2), thickness(2)   !< of the legs along axes 1, 2, from the outer corner [length]
    type(cross_section_type) :: section
    section = rectangles(0.5_DP * reshape([length(1) - thickness(2), 0.0_DP, 0.0_DP, length(2)], [2, 2]), &
      reshape([length(1), thickness(1), thickness(2), length(2) - thickness(1)], [2, 2]))
    section%torsion = (length(1) * thickness(1)**3 + (length(2) - thickness(1)) * thickness(2)**3) / 3
  end function l_section


  !> A hollow hexagon.
  pure function hexagon_section(radius, wall) result(section)
    real(DP), intent(in) :: radius, wall           !< of the outer corners; thickness [length]
    type(cross_section_type) :: section
    real(DP) :: inner, middle
    inner = radius - 2 * wall / sqrt(3.0_DP)
    middle = 0.5_DP * (radius + inner)             ! also the side of the hexagon of the middle lines
    section%area = 1.5_DP * sqrt(3.0_DP) * (radius**2 - inner**2)
    section%about = 5 * sqrt(3.0_DP) / 16 * (radius**4 - inner**4)
    section%torsion = 4 * (1.5_DP * sqrt(3.0_DP) * middle**2)**2 * wall / (6 * middle)
    section%shear_factor = 0.53_DP
  end function hexagon_section


  !> A solid trapezoid, symmetric about axis 2. Its shear centre is taken at the centroid.
  function trapezoid_section(bottom, height, top, node) result(section)
    real(DP), intent(in) :: bottom, height, top    !< widths, and the height along axis 2 [length]
    real(DP), intent(in) :: node                   !< its height over the bottom [length]
    type(cross_section_type) :: section
    section%area = 0.5_DP * (bottom + top) * height
    section%centroid = [0.0_DP, height * (bottom + 2 * top) / (3 * (bottom + top)) - node]
    section%shear_center = section%centroid
    section%about = [height**3 * (bottom**2 + 4 * bottom * top + top**2) / (36 * (bottom + top)), &
      height * (bottom + top) * (bottom**2 + top**2) / 48]
    section%torsion = trapezoid_torsion(bottom, height, top)
    section%shear_factor = 0.822_DP
  end function trapezoid_section


  !> Thin walls one behind the other. The section is open, or one cell whose last point is the first. A wall of thickness 0 goes
  !! back along one before it, so that branches are possible.
  pure subroutine wall_section(points, thickness, section, status)
    real(DP), intent(in) :: points(:, :)           !< (2, walls + 1) along axes 1, 2 from the node [length]
    real(DP), intent(in) :: thickness(:)           !< (walls) [length]
    type(cross_section_type), intent(out) :: section
    integer, intent(out) :: status                 !< WALLS_...
    real(DP) :: length(size(thickness)), x(2, size(thickness) + 1), second(2, 2), cell
    status = wall_status(points, thickness)
    if (status /= WALLS_OK) return
    call measure_walls(points, thickness, length, section%area, section%centroid, second)
    x = points - spread(section%centroid, 2, size(points, 2))
    cell = 0.5_DP * sum(x(1, :size(thickness)) * x(2, 2:) - x(2, :size(thickness)) * x(1, 2:))
    section%about = [second(2, 2), second(1, 1)]
    section%product = second(1, 2)
    section%torsion = sum(length * thickness**3) / 3
    if (is_cell(points)) section%torsion = 4 * cell**2 / sum(length / thickness)
    section%shear_center = shear_center(points, thickness)
    if (.not. second(1, 1) * second(2, 2) - second(1, 2)**2 > 1.0e-12_DP * (second(1, 1) + second(2, 2))**2) status = WALLS_LINE
  end subroutine wall_section


  !> Whether the walls are a tree, or one cell.
  pure integer function wall_status(points, thickness) result(status)
    real(DP), intent(in) :: points(:, :)           !< (2, walls + 1) [length]
    real(DP), intent(in) :: thickness(:)           !< (walls) [length]
    integer :: i, k, n_places
    status = WALLS_OK
    n_places = 0
    do k = 1, size(points, 2)
      if (.not. any([(is_same(points, i, k), i=1, k - 1)])) n_places = n_places + 1
    end do
    do k = 1, size(thickness)
      if (thickness(k) > 0) cycle
      if (.not. any([(thickness(i) > 0 .and. is_same(points, i, k + 1) .and. is_same(points, i + 1, k), i=1, k - 1)])) &
        status = WALLS_LOOSE
    end do
    if (status /= WALLS_OK) return
    if (is_cell(points)) then
      if (n_places /= size(thickness) .or. any(thickness <= 0)) status = WALLS_CELLS
    else if (n_places /= count(thickness > 0) + 1) then
      status = WALLS_CELLS
    end if
  end function wall_status


  !> Whether the last point is the first, and the way there encloses an area.
  pure logical function is_cell(points)
    real(DP), intent(in) :: points(:, :)           !< (2, points) [length]
    real(DP) :: area
    integer :: k
    area = 0
    do k = 2, size(points, 2) - 1
      area = area + (points(1, k) - points(1, 1)) * (points(2, k + 1) - points(2, 1)) - &
        (points(2, k) - points(2, 1)) * (points(1, k + 1) - points(1, 1))
    end do
    is_cell = is_same(points, 1, size(points, 2)) .and. abs(area) > 1.0e-9_DP * extent(points)**2
  end function is_cell


  !> Whether two points are one.
  pure logical function is_same(points, i, k)
    real(DP), intent(in) :: points(:, :)           !< (2, points) [length]
    integer, intent(in) :: i, k
    real(DP), parameter :: TOL_PLACE = 1.0e-6_DP   !< over the size of the section: digits of a deck [-]
    is_same = norm2(points(:, i) - points(:, k)) <= TOL_PLACE * extent(points)
  end function is_same


  !> The size of the section.
  pure real(DP) function extent(points)
    real(DP), intent(in) :: points(:, :)           !< (2, points) [length]
    extent = norm2(maxval(points, 2) - minval(points, 2))
  end function extent


  !> The shear centre of thin walls one behind the other, open or one cell: the pole whose warping function has no moment with the
  !! coordinates. Bredt's shear flow of a cell makes its warping function single-valued.
  pure function shear_center(points, thickness) result(center)
    real(DP), intent(in) :: points(:, :)           !< (2, walls + 1) [length]
    real(DP), intent(in) :: thickness(:)           !< (walls) [length]
    real(DP) :: center(2), length(size(thickness)), warping(size(thickness) + 1), x(2, size(thickness) + 1), flow, area
    real(DP) :: second(2, 2), moment(2), determinant
    integer :: k, n
    n = size(thickness)
    call measure_walls(points, thickness, length, area, center, second)
    x = points - spread(center, 2, n + 1)
    flow = 0
    if (is_cell(points)) flow = sum(x(1, :n) * x(2, 2:) - x(2, :n) * x(1, 2:)) / sum(length / thickness)
    warping(1) = 0
    do k = 1, n
      warping(k + 1) = warping(k) + x(1, k) * x(2, k + 1) - x(2, k) * x(1, k + 1)
      if (abs(flow) > 0) warping(k + 1) = warping(k + 1) - flow * length(k) / thickness(k)
    end do
    moment = 0
    do k = 1, n
      moment = moment + length(k) * thickness(k) / 6 * (warping(k) * (2 * x(:, k) + x(:, k + 1)) + &
        warping(k + 1) * (x(:, k) + 2 * x(:, k + 1)))
    end do
    determinant = second(1, 1) * second(2, 2) - second(1, 2)**2
    if (.not. determinant > 1.0e-12_DP * (second(1, 1) + second(2, 2))**2) return
    center = center + [second(1, 1) * moment(2) - second(1, 2) * moment(1), &
      second(1, 2) * moment(2) - second(2, 2) * moment(1)] / determinant
  end function shear_center


  !> Lengths, area, centroid and central second moments int x x' t ds of the middle lines of walls.
  pure subroutine measure_walls(points, thickness, length, area, centroid, second)
    real(DP), intent(in) :: points(:, :)           !< (2, walls + 1) [length]
    real(DP), intent(in) :: thickness(:)           !< (walls) [length]
    real(DP), intent(out) :: length(:)             !< (walls) [length]
    real(DP), intent(out) :: area, centroid(2)     !< [length^2], [length]
    real(DP), intent(out) :: second(2, 2)          !< [length^4]
    real(DP) :: from(2), to(2)
    integer :: k, n
    n = size(thickness)
    length = norm2(points(:, 2:) - points(:, :n), 1)
    area = sum(length * thickness)
    do k = 1, 2
      centroid(k) = sum(length * thickness * (points(k, :n) + points(k, 2:))) / (2 * area)
    end do
    second = 0
    do k = 1, n
      from = points(:, k) - centroid
      to = points(:, k + 1) - centroid
      second = second + length(k) * thickness(k) / 6 * (2 * outer_product(from, from) + 2 * outer_product(to, to) + &
        outer_product(from, to) + outer_product(to, from))
    end do
  end subroutine measure_walls


  !> Area, centroid and moments of inertia of rectangles along the axes; the shear centre is at the origin.
  pure function rectangles(middle, side, sign) result(section)
    real(DP), intent(in) :: middle(:, :), side(:, :)   !< (2, rectangles) [length]
    real(DP), intent(in), optional :: sign(:)      !< (rectangles) -1: a hole
    type(cross_section_type) :: section
    real(DP) :: area(size(side, 2))
    integer :: k
    area = side(1, :) * side(2, :)
    if (present(sign)) area = sign * area
    section%area = sum(area)
    section%centroid = matmul(middle, area) / section%area
    do k = 1, 2
      section%about(k) = sum(area * (side(3 - k, :)**2 / 12 + (middle(3 - k, :) - section%centroid(3 - k))**2))
    end do
    section%product = sum(area * (middle(1, :) - section%centroid(1)) * (middle(2, :) - section%centroid(2)))
  end function rectangles


  !> The torsion constant of a trapezoid: twice the volume under Prandtl's stress function, which is the product of (1 - xi^2)
  !! (1 - eta^2) and Legendre polynomials on the square -1 to 1 of which the trapezoid is the image. A lower bound.
  real(DP) function trapezoid_torsion(bottom, height, top) result(torsion)
    real(DP), intent(in) :: bottom, height, top    !< widths, and the height [length]
    real(DP), dimension(N_GAUSS) :: place, weight
    real(DP) :: across(N_ACROSS, N_GAUSS), d_across(N_ACROSS, N_GAUSS), along(N_ALONG, N_GAUSS), d_along(N_ALONG, N_GAUSS)
    real(DP) :: K(N_ACROSS * N_ALONG, N_ACROSS * N_ALONG), f(N_ACROSS * N_ALONG), c(N_ACROSS * N_ALONG)
    real(DP), dimension(N_ACROSS * N_ALONG) :: value, slope_1, slope_2
    real(DP) :: half, slope, w
    integer :: i, j, status
    call set_gauss_rule(place, weight)
    do i = 1, N_GAUSS
      call bubble_functions(place(i), 2, across(:, i), d_across(:, i))
      call bubble_functions(place(i), 1, along(:, i), d_along(:, i))
    end do
    slope = (top - bottom) / (2 * height)          ! of the half width
    K = 0
    f = 0
    do j = 1, N_GAUSS
      half = 0.25_DP * (bottom + top) + 0.5_DP * height * slope * place(j)
      do i = 1, N_GAUSS
        value = [outer(across(:, i), along(:, j))]
        slope_1 = [outer(d_across(:, i), along(:, j))] / half
        slope_2 = [outer(across(:, i), d_along(:, j))] * 2 / height - place(i) * slope * slope_1
        w = weight(i) * weight(j) * half * height / 2
        f = f + w * value
        K = K + w * (outer(slope_1, slope_1) + outer(slope_2, slope_2))
      end do
    end do
    call solve_small(K, 2 * f, c, status)
    torsion = 2 * dot_product(f, c)
  end function trapezoid_torsion


  !> (1 - x^2) times Legendre polynomials 0, step, 2 step, ..., and the derivatives.
  pure subroutine bubble_functions(x, step, value, derivative)
    real(DP), intent(in) :: x
    integer, intent(in) :: step
    real(DP), intent(out) :: value(:), derivative(:)
    real(DP), dimension(0:step * size(value)) :: P, dL
    integer :: n
    P(0) = 1
    dL(0) = 0
    P(1) = x
    dL(1) = 1
    do n = 1, ubound(P, 1) - 1
      P(n + 1) = next_legendre(n, x, P(n), P(n - 1))
      dL(n + 1) = dL(n - 1) + real(2 * n + 1, DP) * P(n)
    end do
    do n = 1, size(value)
      value(n) = (1 - x**2) * P(step * (n - 1))
      derivative(n) = (1 - x**2) * dL(step * (n - 1)) - 2 * x * P(step * (n - 1))
    end do
  end subroutine bubble_functions


  !> Gauss's rule of N_GAUSS points on -1 to 1: the roots of the Legendre polynomial by Newton's method.
  pure subroutine set_gauss_rule(place, weight)
    real(DP), intent(out) :: place(N_GAUSS), weight(N_GAUSS)
    real(DP) :: P(0:N_GAUSS), slope
    integer :: i, n, round
    do i = 1, N_GAUSS
      place(i) = -cos(PI * (real(i, DP) - 0.25_DP) / (real(N_GAUSS, DP) + 0.5_DP))
      do round = 1, 6                              ! converges quadratically from a relative error below 1e-3
        P(0) = 1
        P(1) = place(i)
        do n = 1, N_GAUSS - 1
          P(n + 1) = next_legendre(n, place(i), P(n), P(n - 1))
        end do
        slope = real(N_GAUSS, DP) * (P(N_GAUSS - 1) - place(i) * P(N_GAUSS)) / (1 - place(i)**2)
        place(i) = place(i) - P(N_GAUSS) / slope
      end do
      weight(i) = 2 / ((1 - place(i)**2) * slope**2)
    end do
  end subroutine set_gauss_rule


  !> The Legendre polynomial n + 1 at x from those before it.
  pure real(DP) function next_legendre(n, x, this, last)
    integer, intent(in) :: n
    real(DP), intent(in) :: x, this, last          !< polynomials n, n - 1
    next_legendre = (real(2 * n + 1, DP) * x * this - real(n, DP) * last) / real(n + 1, DP)
  end function next_legendre


  !> a b'.
  pure function outer(a, b) result(ab)
    real(DP), intent(in) :: a(:), b(:)
    real(DP) :: ab(size(a), size(b))
    ab = spread(a, 2, size(b)) * spread(b, 1, size(a))
  end function outer


  !> The same of two vectors of the plane.
  pure function outer_product(a, b) result(ab)
    real(DP), intent(in) :: a(2), b(2)
    real(DP) :: ab(2, 2)
    ab = outer(a, b)
  end function outer_product

end module amontons_beam_cross_sections
