!> Crossing: whether a point has gone through a facet between two configurations.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_crossing
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  use amontons_facets, only: facets_type, facet_nodes, facet_tangents, is_line
  use amontons_topology, only: MAX_FACE_NODES, FACET_TRI3, FACET_TRI6
  implicit none
  private
  public :: has_crossed

  real(DP), parameter :: IN_FRONT = 1.0e-3_DP      !< nearer than this times its edge a point did not stand before it [-]

contains

  !> Whether a point stood clearly before a facet and has come behind it, through it: straight, as the facet moves with its middle.
  !! Cost: linear in the facets. An analytic master has no facets of this kind; nothing crosses it here.
  pure logical function has_crossed(facets, x_old, x_new, node)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x_old(:, :), x_new(:, :)   !< (3, n_nodes) coordinates [length]
    integer, intent(in) :: node                    !< the point
    integer :: f
    has_crossed = .false.
    if (allocated(facets%profile)) return
    do f = 1, facets%n
      has_crossed = crosses_facet(facets, x_old, x_new, node, f)
      if (has_crossed) return
    end do
  end function has_crossed


  !> The same of one facet.
  pure logical function crosses_facet(facets, x_old, x_new, node, f) result(does)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x_old(:, :), x_new(:, :)
    integer, intent(in) :: node, f
    real(DP) :: start(3), way(3), normal(3), tangents(3, 2), before, behind, corner(3, 4)
    integer :: n, m, nodes(MAX_FACE_NODES)
    does = .false.
    call facet_nodes(facets, f, n, nodes)
    m = n_corners(facets%kind(f))
    corner(:, :m) = x_new(:, nodes(:m))
    start = x_old(:, node) + (sum(corner(:, :m), dim=2) - sum(x_old(:, nodes(:m)), dim=2)) / real(m, DP)
    way = x_new(:, node) - start
    if (norm2(start - corner(:, 1)) > norm2(way) + 2.0_DP * facets%edge_length(f)) return   ! out of reach
    call facet_tangents(facets, x_new, f, [0.0_DP, 0.0_DP] + merge(1.0_DP / 3.0_DP, 0.0_DP, m == 3), tangents)
    normal = cross_product(tangents(:, 1), tangents(:, 2))
    if (norm2(normal) <= 0.0_DP) return
    normal = normal / norm2(normal)
    before = dot_product(normal, start - corner(:, 1))
    behind = -dot_product(normal, x_new(:, node) - corner(:, 1))
    if (before <= IN_FRONT * facets%edge_length(f) .or. behind <= 0.0_DP) return
    does = is_inside(start + before / (before + behind) * way, corner(:, :m), normal, is_line(facets%kind(f)))
  end function crosses_facet


  !> Corners of a facet.
  pure integer function n_corners(kind)
    integer, intent(in) :: kind                    !< FACET_...
    n_corners = 4
    if (kind == FACET_TRI3 .or. kind == FACET_TRI6) n_corners = 3
    if (is_line(kind)) n_corners = 2
  end function n_corners


  !> Whether a point of the plane of a facet is between its corners.
  pure logical function is_inside(point, corner, normal, is_edge)
    real(DP), intent(in) :: point(3)               !< [length]
    real(DP), intent(in) :: corner(:, :)           !< (3, n) [length]
    real(DP), intent(in) :: normal(3)              !< [-]
    logical, intent(in) :: is_edge                 !< the facet is a line with two ends
    real(DP) :: side(3)
    integer :: k
    if (is_edge) then
      side = corner(:, 2) - corner(:, 1)
      is_inside = abs(dot_product(point - 0.5_DP * (corner(:, 1) + corner(:, 2)), side)) <= 0.5_DP * dot_product(side, side)
      return
    end if
    is_inside = .true.
    do k = 1, size(corner, 2)
      side = corner(:, mod(k, size(corner, 2)) + 1) - corner(:, k)
      is_inside = is_inside .and. dot_product(normal, cross_product(side, point - corner(:, k))) >= 0.0_DP
    end do
  end function is_inside

end module amontons_crossing
