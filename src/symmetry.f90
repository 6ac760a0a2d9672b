!> Symmetry: where a master surface ends on a plane of symmetry, its normals lie in that plane.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A vertex normal at the border of a surface is made from one side only and leans by half a facet. On a plane of symmetry the
!! other half of the body is there too, mirrored: the sum of a normal and its mirror image is twice its part in the plane.
!! Without that a slave node that slides in the plane could never close its gap (doc/theory/contact.md, "The normal").
module amontons_symmetry
  use amontons_kinds, only: DP
  use amontons_facets, only: facets_type, corners_of, is_line, EDGE_FREE
  use amontons_gap, only: vertex_normal
  implicit none
  private
  public :: find_symmetry

  real(DP), parameter :: LEANING = 0.5_DP          !< a larger part of the normal out of the plane is no lean [-]

contains

  !> Finds the vertices on planes of symmetry and the directions that their normals lose: facets%in_plane.
  !!
  !! A free edge of the surface lies on a plane of symmetry if a support holds the same direction at all its nodes, that
  !! direction is nearly perpendicular to the normal, and the direction nearest to the normal is not held.
  subroutine find_symmetry(facets, x, is_held)
    type(facets_type), intent(inout) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates at the start [length]
    logical, intent(in) :: is_held(:, :)           !< (3, n_nodes) by supports
    logical :: on_edge(3)
    integer :: f, k, d
    integer, allocatable :: entries(:)
    if (allocated(facets%profile)) return
    if (facets%is_faceted) return                  ! the normals of its faces are as they are
    if (.not. allocated(facets%in_plane)) allocate (facets%in_plane(3, facets%n_vertices))
    facets%in_plane = 1.0_DP
    do f = 1, facets%n
      do k = 1, corners_of(facets%kind(f))
        if (facets%edge(k, f) /= EDGE_FREE) cycle
        entries = edge_entries(facets, f, k)
        on_edge = [(all(is_held(d, facets%nodes(entries))), d=1, 3)]
        if (any(on_edge)) call keep_in_plane(entries, on_edge)
      end do
    end do

  contains

    !> The vertices of an edge lose the directions in which they only lean.
    subroutine keep_in_plane(entries, on_edge)
      integer, intent(in) :: entries(:)
      logical, intent(in) :: on_edge(3)
      real(DP) :: m(3)
      integer :: i
      do i = 1, size(entries)
        m = vertex_normal(facets, x, facets%vertex(entries(i)), is_whole=.true.)
        if (is_held(maxloc(abs(m), dim=1), facets%nodes(entries(i)))) cycle
        where (on_edge .and. abs(m) <= LEANING * norm2(m)) facets%in_plane(:, facets%vertex(entries(i))) = 0.0_DP
      end do
    end subroutine keep_in_plane

  end subroutine find_symmetry


  !> The entries of facets%nodes on one edge: its corners, and the node between them; of a line its end.
  pure function edge_entries(facets, f, k) result(entries)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f, k                    !< facet and edge
    integer, allocatable :: entries(:)
    integer :: start, n
    start = facets%first(f) - 1
    n = corners_of(facets%kind(f))
    entries = [start + k]
    if (is_line(facets%kind(f))) return
    entries = [start + k, start + modulo(k, n) + 1]
    if (facets%first(f + 1) - facets%first(f) > n) entries = [entries, start + n + k]
  end function edge_entries

end module amontons_symmetry
