!> Thickness of bodies below their exterior faces: how far the body reaches behind each face, through all its elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! What lies behind a face by more than that is beyond the body and does not touch this face. The element below the face may be less
!! deep: a coarse slave reaches through several fine ones.
module amontons_body_thickness
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  use amontons_mesh, only: mesh_type
  use amontons_exterior_surface, only: exterior_type, is_thin
  use amontons_facets, only: facets_type
  use amontons_facet_search, only: facet_search_type, build_facet_search, find_near_facets
  use amontons_surface_projection, only: MIN_OPPOSED_COSINE
  implicit none
  private
  public :: measure_body_thickness

  real(DP), parameter :: TOL_INSIDE = 1.0e-6_DP    !< a ray on the edge of a face hits it; over the square of the edge [-]

contains

  !> The thickness below each face in the reference configuration: the way from its centre along the inward normal to the next face
  !! of the same body that opposes it. Of a thin face (`is_thin`) it is its depth; huge where there is no face within the reach.
  !! Cost: for each face a search among its neighbours for each mean edge that fits into the thickness.
  subroutine measure_body_thickness(mesh, exterior, reach, thickness)
    type(mesh_type), intent(in) :: mesh
    type(exterior_type), intent(in) :: exterior
    real(DP), intent(in) :: reach                  !< a larger thickness is not distinguished from huge [length]
    real(DP), allocatable, intent(out) :: thickness(:)   !< (n) [length]
    type(facets_type) :: boxes
    type(facet_search_type) :: search
    integer, allocatable :: list(:)
    real(DP) :: extent(exterior%n_bodies), step, way
    integer :: f, n, i
    allocate (thickness(exterior%n), source=huge(1.0_DP))
    boxes%n = exterior%n
    boxes%first = [(2 * i - 1, i=1, boxes%n + 1)]
    boxes%nodes = [(i, i=1, 2 * boxes%n)]
    step = sum(exterior%edge_length) / real(max(1, exterior%n), DP)
    extent = body_extents(exterior)
    call build_facet_search(boxes, reshape(exterior%box, [3, 2 * exterior%n]), step, search)
    do f = 1, exterior%n
      if (is_thin(exterior%depth(f), exterior%edge_length(f))) then
        thickness(f) = exterior%depth(f)
        cycle
      end if
      way = 0.0_DP                                 ! along the ray; faces that it hits up to a step farther are found
      do while (way <= min(reach, extent(exterior%body(f))) .and. way + step < thickness(f))
        call find_near_facets(search, exterior%centre(:, f) - way * exterior%normal(:, f), list, n)
        call find_opposed_face(mesh, exterior, f, list(:n), thickness(f))
        way = way + step
      end do
    end do
  end subroutine measure_body_thickness


  !> The diagonals of the boxes of the bodies [length].
  pure function body_extents(exterior) result(extent)
    type(exterior_type), intent(in) :: exterior
    real(DP) :: extent(exterior%n_bodies)
    real(DP) :: low(3, exterior%n_bodies), high(3, exterior%n_bodies)
    integer :: f, b
    low = huge(1.0_DP)
    high = -huge(1.0_DP)
    do f = 1, exterior%n
      low(:, exterior%body(f)) = min(low(:, exterior%body(f)), exterior%box(:, 1, f))
      high(:, exterior%body(f)) = max(high(:, exterior%body(f)), exterior%box(:, 2, f))
    end do
    do b = 1, exterior%n_bodies
      extent(b) = norm2(max(0.0_DP, high(:, b) - low(:, b)))
    end do
  end function body_extents


  !> Lowers the thickness below a face to the way to the nearest of some faces that oppose it.
  pure subroutine find_opposed_face(mesh, exterior, f, list, thickness)
    type(mesh_type), intent(in) :: mesh
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f                       !< face
    integer, intent(in) :: list(:)                 !< faces
    real(DP), intent(inout) :: thickness           !< [length]
    integer :: g, k
    do k = 1, size(list)
      g = list(k)
      if (g == f .or. exterior%body(g) /= exterior%body(f)) cycle
      if (dot_product(exterior%normal(:, f), exterior%normal(:, g)) > -MIN_OPPOSED_COSINE) cycle
      thickness = min(thickness, distance_along(exterior%centre(:, f), -exterior%normal(:, f), exterior%normal(:, g), &
        mesh%coordinates(:, exterior%nodes(exterior%first(g):exterior%first(g) + exterior%n_corners(g) - 1))))
    end do
  end subroutine find_opposed_face


  !> The way from a point along a ray to a face; huge if the ray does not hit it [length].
  pure real(DP) function distance_along(point, ray, normal, corner) result(distance)
    real(DP), intent(in) :: point(3), ray(3)       !< [length]; a unit vector
    real(DP), intent(in) :: normal(3)              !< of the face, not perpendicular to the ray
    real(DP), intent(in) :: corner(:, :)           !< (3, 2 to 4) [length]
    real(DP) :: at(3), along(3)
    integer :: k, n
    n = size(corner, 2)
    distance = dot_product(sum(corner, dim=2) / real(n, DP) - point, normal) / dot_product(ray, normal)
    at = point + distance * ray
    if (distance <= 0.0_DP) distance = huge(1.0_DP)
    do k = 1, n
      along = corner(:, modulo(k, n) + 1) - corner(:, k)
      if (n == 2) then                             ! from each end: not before it
        if (dot_product(along, at - corner(:, k)) < -TOL_INSIDE * dot_product(along, along)) distance = huge(1.0_DP)
      else if (dot_product(cross_product(along, at - corner(:, k)), normal) < -TOL_INSIDE * dot_product(along, along)) then
        distance = huge(1.0_DP)
      end if
    end do
  end function distance_along

end module amontons_body_thickness
