!> Tests of the search for points in a mesh: inside by their natural coordinates, outside against a fine sampling of the element,
!! linear fields in a mesh of many elements, points far away.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_mesh_point_search
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: element_kind, element_kind_type, MAX_ELEMENT_NODES, KIND_C3D4, KIND_C3D6, KIND_C3D8, &
    KIND_C3D10, KIND_C3D15, KIND_C3D20, KIND_CPS3, KIND_CPS4, KIND_CPS6, KIND_CPS8
  use amontons_mesh_point_search, only: located_point_type, locate_points, nearest_in_element, mean_element_size, &
    select_elements, exterior_limit
  use amontons_shape_functions, only: shape_functions, node_coordinates
  use check, only: suite_type
  implicit none
  integer, parameter :: KINDS(10) = [KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D10, KIND_C3D15, KIND_C3D20, KIND_CPS3, KIND_CPS4, &
    KIND_CPS6, KIND_CPS8]
  type(suite_type) :: suite
  integer :: k
  do k = 1, size(KINDS)
    call check_inside(KINDS(k))
    call check_outside(KINDS(k))
  end do
  call check_grid()
  call check_none()
  call check_selection()
  call suite%finish()

contains

  !> A distorted element: an affine map of the parent element, and a wave that bends it.
  subroutine make_element(kind, name, x)
    integer, intent(in) :: kind
    character(:), allocatable, intent(out) :: name
    real(DP), allocatable, intent(out) :: x(:, :)
    type(element_kind_type) :: entry
    real(DP) :: xi(3, MAX_ELEMENT_NODES)
    integer :: i
    entry = element_kind(kind)
    name = trim(entry%name)
    call node_coordinates(kind, xi)
    allocate (x(3, entry%n_nodes), source=0.0_DP)
    do i = 1, entry%n_nodes
      x(1, i) = 3 + 2 * xi(1, i) + 0.3_DP * xi(2, i) + 0.1_DP * sin(2 * xi(2, i) + xi(3, i))
      x(2, i) = 1 + 0.2_DP * xi(1, i) + xi(2, i) + 0.1_DP * sin(xi(1, i) - xi(3, i))
      if (kind < KIND_CPS3) x(3, i) = 0.5_DP * xi(3, i) + 0.1_DP * xi(1, i) + 0.05_DP * sin(2 * xi(1, i) + xi(2, i))
    end do
  end subroutine make_element


  !> Whether natural coordinates belong to the parent element; dims: their number.
  pure logical function is_inside(kind, xi)
    integer, intent(in) :: kind
    real(DP), intent(in) :: xi(3)
    select case (kind)
    case (KIND_C3D4, KIND_C3D10)
      is_inside = all(xi >= 0) .and. sum(xi) <= 1
    case (KIND_C3D6, KIND_C3D15)
      is_inside = all(xi(:2) >= 0) .and. sum(xi(:2)) <= 1 .and. abs(xi(3)) <= 1
    case (KIND_CPS3, KIND_CPS6)
      is_inside = all(xi(:2) >= 0) .and. sum(xi(:2)) <= 1
    case default
      is_inside = all(abs(xi) <= 1)
    end select
  end function is_inside


  !> Points at chosen natural coordinates, nodes among them: the shape functions there come back.
  subroutine check_inside(kind)
    integer, intent(in) :: kind
    character(:), allocatable :: name
    real(DP), allocatable :: x(:, :)
    real(DP) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), weights(MAX_ELEMENT_NODES), xi(3), distance, worst, farthest
    real(DP) :: at_nodes(3, MAX_ELEMENT_NODES)
    integer :: i, j, m
    call make_element(kind, name, x)
    call node_coordinates(kind, at_nodes)
    worst = 0
    farthest = 0
    do i = 0, 4
      do j = 0, 4
        do m = 0, 4
          xi = real([i, j, m], DP) / 2.0_DP - 1
          if (.not. is_inside(kind, xi)) xi = at_nodes(:, 1 + mod(i + 5 * j + 25 * m, size(x, 2)))
          if (kind >= KIND_CPS3) xi(3) = 0
          call shape_functions(kind, xi, N, dN)
          call nearest_in_element(kind, x, matmul(x, N(:size(x, 2))), weights, distance)
          worst = max(worst, maxval(abs(weights - N)))
          farthest = max(farthest, distance)
        end do
      end do
    end do
    call suite%near(name // ' inside: shape functions', worst, 0.0_DP, 1.0e-8_DP)   ! Newton's last step: rounding over the slope
    call suite%near(name // ' inside: distance', farthest, 0.0_DP, 1.0e-12_DP)
  end subroutine check_inside


  !> Points around the element: no sample of it is nearer, and the distance is that of the place.
  subroutine check_outside(kind)
    integer, intent(in) :: kind
    integer, parameter :: M = 40
    character(:), allocatable :: name
    real(DP), allocatable :: x(:, :)
    real(DP) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), weights(MAX_ELEMENT_NODES), xi(3), point(3), distance, best
    real(DP) :: worst_excess, worst_place
    integer :: p, i, j, l
    call make_element(kind, name, x)
    worst_excess = -1
    worst_place = 0
    do p = 1, 12
      point = [3.0_DP, 1.0_DP, 0.0_DP] + [4.0_DP * cos(real(p, DP)), 3.0_DP * sin(real(p, DP)), 1.5_DP * cos(2.5_DP * real(p, DP))]
      call nearest_in_element(kind, x, point, weights, distance)
      worst_place = max(worst_place, abs(norm2(matmul(x, weights(:size(x, 2))) - point) - distance))
      best = huge(best)
      do i = -M, M
        do j = -M, M
          do l = -M, merge(M, -M, kind < KIND_CPS3)
            xi = real([i, j, l], DP) / real(M, DP)
            if (kind >= KIND_CPS3) xi(3) = 0
            if (.not. is_inside(kind, xi)) cycle
            call shape_functions(kind, xi, N, dN)
            best = min(best, norm2(matmul(x, N(:size(x, 2))) - point))
          end do
        end do
      end do
      worst_excess = max(worst_excess, distance - best)
    end do
    call suite%that(name // ' outside: no sample is nearer', worst_excess <= 1.0e-10_DP)
    call suite%near(name // ' outside: distance of the place', worst_place, 0.0_DP, 1.0e-12_DP)
  end subroutine check_outside


  !> A grid of hexahedra: points inside reproduce a linear field; points outside come to the nearest point of the box.
  subroutine check_grid()
    integer, parameter :: M = 6
    real(DP) :: x(3, (M + 1)**3), points(3, 60), u((M + 1)**3), clamped(3), worst, farthest
    integer :: kind(M**3), first(M**3 + 1), nodes(8 * M**3), i, j, k, e, a
    type(located_point_type), allocatable :: located(:)
    do k = 0, M
      do j = 0, M
        do i = 0, M
          x(:, number(i, j, k)) = real([i, j, k], DP) / real(M, DP)
        end do
      end do
    end do
    u = 1 + matmul([2.0_DP, -3.0_DP, 0.5_DP], x)
    e = 0
    do k = 0, M - 1
      do j = 0, M - 1
        do i = 0, M - 1
          e = e + 1
          nodes(8 * e - 7:8 * e) = [number(i, j, k), number(i + 1, j, k), number(i + 1, j + 1, k), number(i, j + 1, k), &
            number(i, j, k + 1), number(i + 1, j, k + 1), number(i + 1, j + 1, k + 1), number(i, j + 1, k + 1)]
        end do
      end do
    end do
    kind = KIND_C3D8
    first = [(8 * a + 1, a=0, M**3)]
    do a = 1, size(points, 2)
      points(:, a) = 0.5_DP + [0.45_DP * cos(3 * real(a, DP)), 0.45_DP * sin(5 * real(a, DP)), &
        0.45_DP * cos(7 * real(a, DP))]
      if (a > 30) points(:, a) = 0.5_DP + 4 * (points(:, a) - 0.5_DP)
      if (a > 55) points(:, a) = 1000 * points(:, a)
    end do
    call locate_points(kind, first, nodes, x, points, located)
    worst = 0
    farthest = 0
    do a = 1, size(points, 2)
      clamped = max(0.0_DP, min(1.0_DP, points(:, a)))
      farthest = max(farthest, abs(located(a)%distance - norm2(clamped - points(:, a))) / max(1.0_DP, norm2(points(:, a))))
      worst = max(worst, abs(dot_product(u(located(a)%nodes(:8)), located(a)%weights(:8)) - 1 - dot_product([2.0_DP, -3.0_DP, &
        0.5_DP], clamped)))
    end do
    call suite%near('grid: field at the nearest points', worst, 0.0_DP, 1.0e-10_DP)
    call suite%near('grid: distances', farthest, 0.0_DP, 1.0e-12_DP)
    call suite%that('grid: inside is 0', all(located(:30)%distance <= 0))
    call suite%near('grid: mean size', mean_element_size(first, nodes, x), 1.0_DP / real(M, DP), 1.0e-12_DP)
  end subroutine check_grid


  !> Node number in the grid.
  pure integer function number(i, j, k)
    integer, intent(in) :: i, j, k
    number = 1 + i + 7 * (j + 7 * k)
  end function number


  !> No elements, no points.
  subroutine check_none()
    type(located_point_type), allocatable :: located(:)
    real(DP) :: x(3, 0), points(3, 1)
    points = 0
    call locate_points([integer ::], [1], [integer ::], x, points, located)
    call suite%that('no elements', size(located) == 1 .and. located(1)%element == 0 .and. located(1)%distance > 1.0e300_DP)
    call locate_points([integer ::], [1], [integer ::], x, points(:, :0), located)
    call suite%that('no points', size(located) == 0)
  end subroutine check_none


  !> Two of three elements, and the smaller of two tolerances.
  subroutine check_selection()
    integer, allocatable :: kind(:), first(:), nodes(:)
    call select_elements([1, 2, 3], [1, 5, 8, 12], [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11], [2, 3], kind, first, nodes)
    call suite%that('two of three elements', all(kind == [2, 3]) .and. all(first == [1, 4, 8]) .and. &
      all(nodes == [5, 6, 7, 8, 9, 10, 11]))
    call suite%near('over the mean size', exterior_limit(0.05_DP, 1.0_DP, 2.0_DP), 0.1_DP, 1e-15_DP)
    call suite%near('a distance alone', exterior_limit(huge(1.0_DP), 1.0_DP, 2.0_DP), 1.0_DP, 0.0_DP)
  end subroutine check_selection

end program test_mesh_point_search
