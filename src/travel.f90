!> Travel: how far slave nodes go over their master within an increment, and whether one has passed through it.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_travel
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_state, only: slave_type, STATUS_OPEN
  use amontons_rows, only: contact_row_type, relative_position
  use amontons_analytic, only: bending_at
  use amontons_crossing, only: has_crossed
  use amontons_contact, only: contact_type, touching_row
  implicit none
  private
  public :: farthest_travel, passed_through

  real(DP), parameter :: OUT_OF_SIGHT = 3.0_DP    !< a node deeper than this times the longest edge of its master is not found [-]

contains

  !> How far a change of displacement moves the slave nodes along their master, in facets, at most. A facet is as long as it is
  !! in the direction of the motion: a long and narrow one is crossed where it is narrow. On a profile half the radius of its
  !! curvature counts, so where it is flat there is no limit.
  pure real(DP) function farthest_travel(contact, model, slaves, du) result(farthest)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slaves(:)
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    type(contact_row_type) :: row
    real(DP) :: d(3)
    integer :: s
    farthest = 0.0_DP
    do s = 1, size(slaves)
      associate (slave => slaves(s))
        if (slave%facet == 0 .or. contact%is_small(slave%pair)) cycle
        call touching_row(contact, slave, row)
        d = relative_position(row, du)
        d = d - dot_product(slave%normal, d) * slave%normal
        if (norm2(d) <= 0.0_DP) cycle
        associate (facets => contact%facets(slave%pair))
          if (allocated(facets%profile)) then
            farthest = max(farthest, norm2(d) * bending_at(facets, slave%facet, slave%xi))
            cycle
          end if
          farthest = max(farthest, norm2(d) / width_along(model%mesh%coordinates(:, facets%nodes(facets%first(slave%facet): &
            facets%first(slave%facet + 1) - 1)), d / norm2(d), facets%edge_length(slave%facet)))
        end associate
      end associate
    end do
  end function farthest_travel


  !> The extent of points along a direction; another length where they have none.
  pure real(DP) function width_along(points, direction, otherwise) result(width)
    real(DP), intent(in) :: points(:, :)           !< (3, :) [length]
    real(DP), intent(in) :: direction(3), otherwise
    real(DP) :: along(size(points, 2))
    along = matmul(direction, points)
    width = maxval(along) - minval(along)
    if (width <= 1.0e-6_DP * otherwise) width = otherwise
  end function width_along


  !> The first slave that has passed through its master within the increment; 0 if there is none. Two signs are looked for:
  !! a node that stood before its master and is now out of sight behind the place where it stood, deeper than the search looks
  !! (over the edge of the master too: the path between is not known); and a node that the search does not see, or sees
  !! before another side of the master, or that came from out of sight, whose straight way goes through a facet from the front.
  pure integer function passed_through(contact, x_old, x_new, old, new) result(found)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x_old(:, :), x_new(:, :)   !< (3, n_nodes) at the start and at the end of the increment [length]
    type(slave_type), intent(in) :: old(:)         !< (n_slaves) at the start of the increment
    type(slave_type), intent(in) :: new(:)         !< (n_slaves) at its end
    type(contact_row_type) :: row
    integer :: s
    do found = 1, size(new)
      s = found
      if (contact%is_removed(new(s)%pair)) cycle
      if (.not. contact%overlaps%is_kept(s)) cycle   ! the other side of a symmetric pair watches
      if (old(s)%facet > 0 .and. new(s)%facet == 0) then
        call touching_row(contact, old(s), row)
        if (dot_product(old(s)%normal, relative_position(row, x_new)) < -OUT_OF_SIGHT * contact%edge(old(s)%pair)) return
      end if
      if (contact%is_small(new(s)%pair) .or. .not. is_suspect(old(s), new(s))) cycle
      if (has_crossed(contact%facets(new(s)%pair), x_old, x_new, new(s)%node)) return
    end do
    found = 0
  end function passed_through


  !> Whether a node may have passed through its master: it does not touch, and is not on the side where it stood.
  pure logical function is_suspect(old, new)
    type(slave_type), intent(in) :: old, new
    is_suspect = new%status == STATUS_OPEN
    if (old%facet > 0 .and. new%facet > 0) is_suspect = is_suspect .and. dot_product(old%normal, new%normal) < 0.0_DP
  end function is_suspect

end module amontons_travel
