!> Thickness of bodies below their exterior faces: how far the body reaches behind each face, through all its elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! What lies behind a face by more than that is beyond the body and does not touch this face. The element below the face may be less
!! deep: a coarse slave reaches through several fine ones.
module amontons_body_thickness
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type
  use amontons_exterior_surface, only: exterior_type, is_thin
  use amontons_facets, only: facets_type
  use amontons_facet_crossing, only: distance_along
  use amontons_facet_search, only: facet_search_type, build_facet_search, find_near_facets
  implicit none
  private
  public :: measure_body_thickness

contains

  !> The thickness below each face in the reference configuration: the way from its centre along the inward normal to the face of
  !! the same body where it leaves it. Of a thin face (`is_thin`) it is its depth; huge where there is no face within the reach.
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
        call find_far_side(mesh, exterior, f, list(:n), thickness(f))
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


  !> Lowers the thickness below a face to the way to the nearest of some faces on the far side.
  pure subroutine find_far_side(mesh, exterior, f, list, thickness)
    type(mesh_type), intent(in) :: mesh
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f                       !< face
    integer, intent(in) :: list(:)                 !< faces
    real(DP), intent(inout) :: thickness           !< [length]
    integer :: g, k
    do k = 1, size(list)
      g = list(k)
      if (g == f .or. exterior%body(g) /= exterior%body(f)) cycle
      thickness = min(thickness, distance_along(exterior%centre(:, f), -exterior%normal(:, f), exterior%normal(:, g), &
        mesh%coordinates(:, exterior%nodes(exterior%first(g):exterior%first(g) + exterior%n_corners(g) - 1))))
    end do
  end subroutine find_far_side

end module amontons_body_thickness
