!> Segments and rays that pass through a facet: its mean plane, and the point where they cross it.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_facet_crossing
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  implicit none
  private
  public :: plane_normal, is_inside_facet, cross_facet, distance_along

  real(DP), parameter :: TOL_INSIDE = 1.0e-6_DP    !< a ray on the edge of a face hits it; over the square of the edge [-]
  real(DP), parameter :: MIN_LEAVING_COSINE = 1.0e-3_DP    !< of ray and normal where a ray leaves a body [-]

contains

  !> Outward unit normal of the mean plane of the corners; 0 for zero area [-].
  pure function plane_normal(corner, is_edge) result(normal)
    real(DP), intent(in) :: corner(:, :)           !< (3, n) [length]
    logical, intent(in) :: is_edge                 !< the facet is a line with two ends
    real(DP) :: normal(3)
    integer :: n
    n = size(corner, 2)
    if (is_edge) then
      normal = cross_product(corner(:, 2) - corner(:, 1), [0.0_DP, 0.0_DP, 1.0_DP])
    else
      normal = cross_product(corner(:, 3) - corner(:, 1), corner(:, n) - corner(:, 2))
      if (n == 3) normal = cross_product(corner(:, 2) - corner(:, 1), corner(:, 3) - corner(:, 1))
    end if
    normal = normal / max(norm2(normal), tiny(1.0_DP))
  end function plane_normal


  !> Whether a point in the plane of a facet lies within its corners.
  pure logical function is_inside_facet(point, corner, normal, is_edge)
    real(DP), intent(in) :: point(3)               !< [length]
    real(DP), intent(in) :: corner(:, :)           !< (3, n) [length]
    real(DP), intent(in) :: normal(3)              !< [-]
    logical, intent(in) :: is_edge                 !< the facet is a line with two ends
    real(DP) :: side(3)
    integer :: k
    if (is_edge) then
      side = corner(:, 2) - corner(:, 1)
      is_inside_facet = abs(dot_product(point - 0.5_DP * (corner(:, 1) + corner(:, 2)), side)) <= 0.5_DP * dot_product(side, side)
      return
    end if
    is_inside_facet = .true.
    do k = 1, size(corner, 2)
      side = corner(:, mod(k, size(corner, 2)) + 1) - corner(:, k)
      is_inside_facet = is_inside_facet .and. dot_product(normal, cross_product(side, point - corner(:, k))) >= 0.0_DP
    end do
  end function is_inside_facet


  !> Where a segment passes through a facet; the ends lie on different sides of its mean plane.
  pure subroutine cross_facet(corner, ends, is_crossed, point)
    real(DP), intent(in) :: corner(:, :)           !< (3, 2 to 4); two: an edge of a plane element [length]
    real(DP), intent(in) :: ends(3, 2)             !< of the segment [length]
    logical, intent(out) :: is_crossed
    real(DP), intent(out) :: point(3)              !< of the crossing; else the centre of the facet [length]
    real(DP) :: normal(3), centre(3), height(2)
    normal = plane_normal(corner, size(corner, 2) == 2)
    centre = sum(corner, dim=2) / real(size(corner, 2), DP)
    point = centre
    height = matmul(normal, ends - spread(centre, 2, 2))
    is_crossed = height(1) * height(2) < 0.0_DP
    if (.not. is_crossed) return
    point = ends(:, 1) + height(1) / (height(1) - height(2)) * (ends(:, 2) - ends(:, 1))
    is_crossed = is_inside_facet(point, corner, normal, size(corner, 2) == 2)
    if (.not. is_crossed) point = centre
  end subroutine cross_facet


  !> The way from a point inside a body along a ray to a face; huge if the ray does not leave the body there [length].
  pure real(DP) function distance_along(point, ray, normal, corner) result(distance)
    real(DP), intent(in) :: point(3), ray(3)       !< [length]; a unit vector
    real(DP), intent(in) :: normal(3)              !< of the face, outward
    real(DP), intent(in) :: corner(:, :)           !< (3, 2 to 4) [length]
    real(DP) :: at(3), along(3)
    integer :: k, n
    distance = huge(1.0_DP)
    if (dot_product(ray, normal) < MIN_LEAVING_COSINE) return
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

end module amontons_facet_crossing
