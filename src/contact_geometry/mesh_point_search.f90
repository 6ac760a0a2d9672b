!> Points in a mesh: the element that contains a point, or else the nearest point of the mesh, with the shape functions there.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The elements whose boxes contain a point come from `facet_search`. In each the distance |x(xi) - p| is minimized over the parent
!! domain of the natural coordinates xi by a Gauss-Newton iteration whose steps solve the quadratic problem with the bounds of the
!! domain exactly: they are the best of the stationary points on the domain, its faces, edges and corners. Of points inside the
!! iteration is Newton's. For points outside the margin of the search doubles until the nearest element lies within it. Cost: of a
!! point inside constant; of one outside the number of elements as near as the nearest one.
!! Reference: R. Fletcher, Practical methods of optimization, 2nd ed., sections 6.1 (Gauss-Newton) and 10.3 (active sets).
module amontons_mesh_point_search
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: MAX_ELEMENT_NODES, N_SOLID_KINDS, KIND_C3D4, KIND_C3D6, KIND_C3D10, KIND_C3D15, KIND_CSS6
  use amontons_facet_search, only: facet_search_type, build_facet_search, find_near_facets
  use amontons_facets, only: facets_type
  use amontons_shape_functions, only: shape_functions
  implicit none
  private
  public :: located_point_type, locate_points, nearest_in_element, mean_element_size, select_elements, exterior_limit

  integer, parameter :: MAX_PROJECTION_STEPS = 50
  integer, parameter :: MAX_HALVINGS = 20
  integer, parameter :: MAX_BOUNDS = 6                 !< of a parent domain
  real(DP), parameter :: TOL_ON_ELEMENT = 1.0e-9_DP        !< distance over the size of the element that is rounding [-]
  real(DP), parameter :: TOL_STEP = 1.0e-13_DP         !< natural coordinates that have converged [-]
  real(DP), parameter :: TOL_BOUND = 1.0e-12_DP        !< a bound is kept to this [-]
  real(DP), parameter :: MIN_RELATIVE_PIVOT = 1.0e-13_DP        !< smallest pivot over the largest entry [-]

  !> Where a point is in a mesh.
  type :: located_point_type
    integer :: element = 0                             !< index; 0: the mesh has no elements
    integer :: n_nodes = 0
    integer :: nodes(MAX_ELEMENT_NODES) = 0            !< of this element
    real(DP) :: weights(MAX_ELEMENT_NODES) = 0         !< shape functions at the place [-]
    real(DP) :: xi(3) = 0                              !< its natural coordinates [-]
    real(DP) :: distance = huge(1.0_DP)                !< from the place to the point; 0 inside [length]
  end type located_point_type

contains

  !> Locates points. Elements at the same distance: the one of the lowest index.
  subroutine locate_points(kind, first, nodes, coordinates, points, located)
    integer, intent(in) :: kind(:)                     !< (elements) KIND_... of solids, plane or axisymmetric elements
    integer, intent(in) :: first(:)                    !< (elements + 1) start of an element's nodes
    integer, intent(in) :: nodes(:)
    real(DP), intent(in) :: coordinates(:, :)          !< (3, n_nodes) [length]
    real(DP), intent(in) :: points(:, :)               !< (3, points) [length]
    type(located_point_type), allocatable, intent(out) :: located(:)   !< (points)
    type(facets_type) :: elements
    type(facet_search_type) :: search
    logical, allocatable :: is_done(:)
    real(DP) :: margin, largest
    integer :: i
    allocate (located(size(points, 2)))
    allocate (is_done(size(points, 2)), source=.false.)
    if (size(kind) == 0 .or. size(points, 2) == 0) return
    elements%n = size(kind)
    elements%first = first
    elements%nodes = nodes
    largest = 4 * norm2(max(maxval(coordinates, dim=2), maxval(points, dim=2)) - &
      min(minval(coordinates, dim=2), minval(points, dim=2)))
    margin = 0
    do
      call build_facet_search(elements, coordinates, margin, search)
      do i = 1, size(points, 2)
        if (.not. is_done(i)) call locate_point(elements, kind, coordinates, search, points(:, i), located(i))
        is_done(i) = is_done(i) .or. located(i)%distance <= margin
      end do
      if (all(is_done) .or. margin > largest) exit
      if (.not. margin > 0) margin = mean_element_size(first, nodes, coordinates) / 2
      margin = 2 * margin
    end do
  end subroutine locate_points


  !> The mean of the largest sides of the boxes of elements [length].
  pure real(DP) function mean_element_size(first, nodes, x) result(mean)
    integer, intent(in) :: first(:), nodes(:)
    real(DP), intent(in) :: x(:, :)                    !< (3, n_nodes) [length]
    integer :: e, n
    n = size(first) - 1
    mean = 0
    do e = 1, n
      associate (own => x(:, nodes(first(e):first(e + 1) - 1)))
        mean = mean + maxval(maxval(own, dim=2) - minval(own, dim=2)) / real(n, DP)
      end associate
    end do
    mean = max(mean, tiny(1.0_DP))
  end function mean_element_size


  !> Some elements of a mesh, one after the other.
  pure subroutine select_elements(kind, first, nodes, chosen, own_kind, own_first, own_nodes)
    integer, intent(in) :: kind(:)                     !< (elements)
    integer, intent(in) :: first(:)                    !< (elements + 1) start of an element's nodes
    integer, intent(in) :: nodes(:)
    integer, intent(in) :: chosen(:)                   !< indices of elements
    integer, allocatable, intent(out) :: own_kind(:), own_first(:), own_nodes(:)   !< the same of the chosen elements
    integer :: i
    own_kind = kind(chosen)
    allocate (own_first(size(chosen) + 1))
    own_first(1) = 1
    do i = 1, size(chosen)
      own_first(i + 1) = own_first(i) + first(chosen(i) + 1) - first(chosen(i))
    end do
    allocate (own_nodes(own_first(size(chosen) + 1) - 1))
    do i = 1, size(chosen)
      own_nodes(own_first(i):own_first(i + 1) - 1) = nodes(first(chosen(i)):first(chosen(i) + 1) - 1)
    end do
  end subroutine select_elements


  !> How far a point may be outside: the smaller of both tolerances [length].
  pure real(DP) function exterior_limit(exterior, absolute, mean_size) result(limit)
    real(DP), intent(in) :: exterior                   !< over the mean size of the elements; huge: it does not count [-]
    real(DP), intent(in) :: absolute                   !< [length]
    real(DP), intent(in) :: mean_size                  !< [length]
    limit = absolute
    if (exterior < huge(limit)) limit = min(limit, exterior * mean_size)
  end function exterior_limit


  !> The nearest of the elements that the search finds at a point.
  subroutine locate_point(elements, kind, x, search, point, located)
    type(facets_type), intent(in) :: elements
    integer, intent(in) :: kind(:)
    real(DP), intent(in) :: x(:, :), point(3)
    type(facet_search_type), intent(in) :: search
    type(located_point_type), intent(inout) :: located
    integer, allocatable :: list(:)
    real(DP) :: weights(MAX_ELEMENT_NODES), xi(3), distance, size_of_element
    integer :: i, e, n
    call find_near_facets(search, point, list, n)
    do i = 1, n
      e = list(i)
      associate (own => elements%nodes(elements%first(e):elements%first(e + 1) - 1))
        if (box_distance(x(:, own), point, size_of_element) >= located%distance) cycle
        call nearest_in_element(kind(e), x(:, own), point, weights, distance, xi)
        if (distance <= TOL_ON_ELEMENT * size_of_element) distance = 0
        if (distance >= located%distance) cycle
        located%element = e
        located%n_nodes = size(own)
        located%nodes(:size(own)) = own
        located%weights = weights
        located%xi = xi
        located%distance = distance
      end associate
      if (.not. located%distance > 0) exit
    end do
  end subroutine locate_point


  !> A lower bound of the distance from a point to an element, whose curved faces may bulge out of the box of its nodes.
  real(DP) function box_distance(x, point, size_of_element) result(distance)
    real(DP), intent(in) :: x(:, :), point(3)          !< x: (3, nodes)
    real(DP), intent(out) :: size_of_element           !< largest side of the box [length]
    real(DP), parameter :: BULGE = 0.12_DP             !< over the size of the box, as of facet_search [-]
    real(DP) :: low(3), high(3)
    low = minval(x, dim=2)
    high = maxval(x, dim=2)
    size_of_element = maxval(high - low)
    distance = norm2(max(0.0_DP, low - point, point - high))
    distance = max(0.0_DP, distance - BULGE * size_of_element)
  end function box_distance


  !> The point of an element nearest to a given one, by its shape functions.
  pure subroutine nearest_in_element(kind, x, point, weights, distance, natural)
    integer, intent(in) :: kind                        !< KIND_...
    real(DP), intent(in) :: x(:, :)                    !< (3, nodes) [length]
    real(DP), intent(in) :: point(3)                   !< [length]
    real(DP), intent(out) :: weights(MAX_ELEMENT_NODES)!< [-]
    real(DP), intent(out) :: distance                  !< [length]
    real(DP), intent(out), optional :: natural(3)      !< its natural coordinates [-]
    real(DP) :: bound(3, MAX_BOUNDS), limit(MAX_BOUNDS), xi(3), step(3), rest(3), J(3, 3), trial_weights(MAX_ELEMENT_NODES)
    real(DP) :: trial_rest(3), trial_J(3, 3), share
    integer :: n_dims, n_bounds, iteration, k
    call parent_domain(kind, n_dims, n_bounds, bound, limit, xi)
    call evaluate(xi, weights, rest, J)
    do iteration = 1, MAX_PROJECTION_STEPS
      call bounded_step(n_dims, J, rest, n_bounds, bound, limit, xi, step)
      share = 1
      do k = 1, MAX_HALVINGS
        call evaluate(xi + share * step, trial_weights, trial_rest, trial_J)
        if (norm2(trial_rest) < norm2(rest)) exit
        share = share / 2
      end do
      if (k > MAX_HALVINGS) exit                       ! no step is better: the nearest point
      xi = xi + share * step
      weights = trial_weights
      rest = trial_rest
      J = trial_J
      if (maxval(abs(share * step)) <= TOL_STEP) exit
    end do
    distance = norm2(rest)
    if (present(natural)) natural = xi

  contains

    !> Shape functions, what is missing to the point, and the derivative of the place.
    pure subroutine evaluate(at, N, missing, derivative)
      real(DP), intent(in) :: at(3)
      real(DP), intent(out) :: N(MAX_ELEMENT_NODES), missing(3), derivative(3, 3)
      real(DP) :: dN(3, MAX_ELEMENT_NODES)
      integer :: nodes
      nodes = size(x, 2)
      call shape_functions(kind, at, N, dN)
      missing = point - matmul(x, N(:nodes))
      derivative = matmul(x, transpose(dN(:, :nodes)))
    end subroutine evaluate

  end subroutine nearest_in_element


  !> The bounds of natural coordinates, bound . xi <= limit, and the centre.
  pure subroutine parent_domain(kind, n_dims, n_bounds, bound, limit, centre)
    integer, intent(in) :: kind                        !< KIND_...
    integer, intent(out) :: n_dims, n_bounds
    real(DP), intent(out) :: bound(3, MAX_BOUNDS), limit(MAX_BOUNDS), centre(3)
    integer :: k
    bound = 0
    limit = 0
    centre = 0
    n_bounds = 0
    n_dims = merge(3, 2, kind <= N_SOLID_KINDS)
    select case (kind)
    case (KIND_C3D4, KIND_C3D10)
      call set_simplex(3, n_bounds, bound, limit, centre)
    case (KIND_C3D6, KIND_C3D15, KIND_CSS6)
      call set_simplex(2, n_bounds, bound, limit, centre)
      n_bounds = 5
      bound(3, 4:5) = [1.0_DP, -1.0_DP]
      limit(4:5) = 1
    case default
      if (kind > N_SOLID_KINDS .and. is_triangle(kind)) then
        call set_simplex(2, n_bounds, bound, limit, centre)
        return
      end if
      n_bounds = 2 * n_dims
      do k = 1, n_dims
        bound(k, 2 * k - 1:2 * k) = [1.0_DP, -1.0_DP]
      end do
      limit(:n_bounds) = 1
    end select
  end subroutine parent_domain


  !> Natural coordinates not below 0, with a sum of at most 1.
  pure subroutine set_simplex(n_dims, n_bounds, bound, limit, centre)
    integer, intent(in) :: n_dims
    integer, intent(inout) :: n_bounds
    real(DP), intent(inout) :: bound(3, MAX_BOUNDS), limit(MAX_BOUNDS), centre(3)
    integer :: i
    n_bounds = n_dims + 1
    do i = 1, n_dims
      bound(i, i) = -1
    end do
    bound(:n_dims, n_dims + 1) = 1
    limit(n_dims + 1) = 1
    centre(:n_dims) = 1.0_DP / real(n_dims + 1, DP)
  end subroutine set_simplex


  !> Whether a plane kind is a triangle: its shape functions at a corner of the triangle are 0 or 1.
  pure logical function is_triangle(kind)
    integer, intent(in) :: kind
    real(DP) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    call shape_functions(kind, [0.0_DP, 0.0_DP, 0.0_DP], N, dN)
    is_triangle = abs(N(1) - 1) < 0.5_DP
  end function is_triangle


  !> The step d that minimizes |J d - r| with the bounds on xi + d: the best stationary point with up to n_dims bounds active.
  pure subroutine bounded_step(n_dims, J, r, n_bounds, bound, limit, xi, step)
    integer, intent(in) :: n_dims, n_bounds
    real(DP), intent(in) :: J(3, 3), r(3), bound(3, MAX_BOUNDS), limit(MAX_BOUNDS), xi(3)
    real(DP), intent(out) :: step(3)
    real(DP) :: slack(MAX_BOUNDS), trial(3), best, value
    integer :: set, a, n_active, active(MAX_BOUNDS)
    logical :: is_regular
    slack(:n_bounds) = limit(:n_bounds) - matmul(xi, bound(:, :n_bounds))
    step = 0
    best = norm2(r)
    do set = 0, 2**n_bounds - 1
      if (popcnt(set) > n_dims) cycle
      n_active = 0
      do a = 1, n_bounds
        if (.not. btest(set, a - 1)) cycle
        n_active = n_active + 1
        active(n_active) = a
      end do
      call stationary_step(n_dims, J, r, bound(:, active(:n_active)), slack(active(:n_active)), trial, is_regular)
      if (.not. is_regular) cycle
      if (any(matmul(trial, bound(:, :n_bounds)) > slack(:n_bounds) + TOL_BOUND)) cycle
      value = norm2(matmul(J, trial) - r)
      if (value < best) then
        best = value
        step = trial
      end if
      if (set == 0) exit                               ! nothing can be better
    end do
  end subroutine bounded_step


  !> The step with some bounds active: J'J d + A m = J'r, A'd = slack.
  pure subroutine stationary_step(n_dims, J, r, A, slack, step, is_regular)
    integer, intent(in) :: n_dims
    real(DP), intent(in) :: J(3, 3), r(3)
    real(DP), intent(in) :: A(:, :)                    !< (3, active bounds)
    real(DP), intent(in) :: slack(:)                    !< (active bounds)
    real(DP), intent(out) :: step(3)
    logical, intent(out) :: is_regular
    real(DP) :: matrix(6, 7), scale
    integer :: n, m
    m = n_dims
    n = m + size(A, 2)
    matrix = 0
    matrix(:m, :m) = matmul(transpose(J(:, :m)), J(:, :m))
    scale = max(maxval(abs(matrix(:m, :m))), tiny(1.0_DP))
    matrix(:m, :m) = matrix(:m, :m) / scale
    matrix(:m, 7) = matmul(transpose(J(:, :m)), r) / scale
    matrix(:m, m + 1:n) = A(:m, :)
    matrix(m + 1:n, :m) = transpose(A(:m, :))
    matrix(m + 1:n, 7) = slack
    call eliminate(n, matrix, is_regular)
    step = 0
    step(:m) = matrix(:m, 7)
  end subroutine stationary_step


  !> Gaussian elimination with partial pivoting; column 7 is the right-hand side and becomes the solution.
  pure subroutine eliminate(n, matrix, is_regular)
    integer, intent(in) :: n
    real(DP), intent(inout) :: matrix(6, 7)
    logical, intent(out) :: is_regular
    real(DP) :: row(7)
    integer :: k, p, i
    is_regular = .true.
    do k = 1, n
      p = k - 1 + maxloc(abs(matrix(k:n, k)), dim=1)
      is_regular = abs(matrix(p, k)) > MIN_RELATIVE_PIVOT
      if (.not. is_regular) return
      row = matrix(p, :)
      matrix(p, :) = matrix(k, :)
      matrix(k, :) = row / row(k)
      do i = 1, n
        if (i /= k) matrix(i, :) = matrix(i, :) - matrix(i, k) * matrix(k, :)
      end do
    end do
  end subroutine eliminate

end module amontons_mesh_point_search
