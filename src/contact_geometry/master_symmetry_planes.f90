!> Corrects master normals on symmetry planes by the supports of the nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A vertex normal at the border of a surface is averaged from one side only and tilts by half the angle of a facet. On a symmetry
!! plane the mirrored half of the body continues the surface: the sum of a normal and its mirror image is twice its part in the
!! plane. Without the correction a slave node that slides in the plane could never close its gap (doc/theory/contact.md, "The smooth
!! normal").
module amontons_master_symmetry_planes
  use amontons_kinds, only: DP
  use amontons_model, only: model_type, dof_direction
  use amontons_steps, only: step_type
  use amontons_facets, only: facets_type, n_facet_corners, is_line_facet, EDGE_FREE
  use amontons_surface_projection, only: evaluate_vertex_normal
  implicit none
  private
  public :: find_symmetry_planes, find_fixed_directions

  real(DP), parameter :: MAX_NORMAL_LEAN = 0.5_DP  !< a larger part of the normal out of the plane is no tilt by averaging [-]
  real(DP), parameter :: MIN_AXIS_COSINE = 1.0_DP - 1.0e-9_DP   !< directions with a larger cosine coincide [-]

contains

  !> Finds the vertices on symmetry planes and removes the perpendicular directions from their normals: facets%symmetry_projector.
  !!
  !! A free edge of the surface lies on a symmetry plane if supports fix the same direction at all its nodes, that direction is
  !! nearly perpendicular to the normal, and the direction nearest to the normal is not fixed. The directions are those of the
  !! node's local coordinate system (*TRANSFORM), or the global axes.
  subroutine find_symmetry_planes(facets, model, is_fixed)
    type(facets_type), intent(inout) :: facets
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_fixed(:, :)           !< (3, n_nodes) by supports, from find_fixed_directions
    logical :: is_edge_fixed(3)
    integer :: f, k, d
    integer, allocatable :: entries(:)
    if (allocated(facets%profile)) return
    if (facets%is_faceted) return                  ! the normals of its faces need no correction
    if (.not. allocated(facets%symmetry_projector)) allocate (facets%symmetry_projector(3, 3, facets%n_vertices))
    facets%symmetry_projector = 0.0_DP
    do d = 1, 3
      facets%symmetry_projector(d, d, :) = 1.0_DP
    end do
    do f = 1, facets%n
      do k = 1, n_facet_corners(facets%kind(f))
        if (facets%edge(k, f) /= EDGE_FREE) cycle
        entries = list_edge_entries(facets, f, k)
        is_edge_fixed = [(is_fixed_at_all(d, facets%nodes(entries)), d=1, 3)]
        if (any(is_edge_fixed)) call project_edge_normals(entries, is_edge_fixed)
      end do
    end do

  contains

    !> Whether direction d of the first node is fixed at all of them.
    pure logical function is_fixed_at_all(d, nodes)
      integer, intent(in) :: d, nodes(:)
      real(DP) :: a(3)
      integer :: i, e
      a = dof_direction(model, nodes(1), d)
      is_fixed_at_all = .true.
      do i = 1, size(nodes)
        is_fixed_at_all = is_fixed_at_all .and. any([(is_fixed(e, nodes(i)) .and. &
          abs(dot_product(a, dof_direction(model, nodes(i), e))) > MIN_AXIS_COSINE, e=1, 3)])
      end do
    end function is_fixed_at_all

    !> Removes from the vertex normals of an edge the fixed directions that are nearly perpendicular to them.
    subroutine project_edge_normals(entries, is_edge_fixed)
      integer, intent(in) :: entries(:)
      logical, intent(in) :: is_edge_fixed(3)
      real(DP) :: m(3), axes(3, 3), a(3)
      integer :: i, d
      do i = 1, size(entries)
        m = evaluate_vertex_normal(facets, model%mesh%coordinates, facets%vertex(entries(i)), is_whole=.true.)
        axes = reshape([(dof_direction(model, facets%nodes(entries(i)), d), d=1, 3)], [3, 3])
        if (is_fixed(maxloc(abs(matmul(m, axes)), dim=1), facets%nodes(entries(i)))) cycle
        do d = 1, 3
          a = dof_direction(model, facets%nodes(entries(1)), d)
          if (.not. is_edge_fixed(d) .or. abs(dot_product(a, m)) > MAX_NORMAL_LEAN * norm2(m)) cycle
          associate (part => facets%symmetry_projector(:, :, facets%vertex(entries(i))))
            part = part - spread(a, 2, 3) * spread(matmul(a, part), 1, 3)
          end associate
        end do
      end do
    end subroutine project_edge_normals

  end subroutine find_symmetry_planes


  !> Directions of each node that supports fix: of its local coordinate system (*TRANSFORM), or the global axes.
  pure subroutine find_fixed_directions(model, step, owner, is_fixed)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    integer, intent(in) :: owner(:)                !< (3 n_nodes) < 0: fixed by a support in a global direction
    logical, intent(out) :: is_fixed(:, :)          !< (3, n_nodes)
    integer :: i, d
    is_fixed = reshape(owner < 0, shape(is_fixed))
    if (.not. allocated(model%frame_of)) return
    do i = 1, model%mesh%n_nodes
      if (model%frame_of(i) == 0) cycle
      associate (is_axis_held => owner(3 * i - 2:3 * i) < 0)   ! a local axis may coincide with a global one
        is_fixed(:, i) = [(any(is_axis_held .and. abs(dof_direction(model, i, d)) > MIN_AXIS_COSINE), d=1, 3)]
      end associate
    end do
    do i = 1, size(step%prescribed)
      associate (load => step%prescribed(i))
        if (load%dof <= 3) is_fixed(load%dof, load%node) = .true.
      end associate
    end do
  end subroutine find_fixed_directions


  !> The entries of facets%nodes on one edge: its corners and the node between them; for a line its end.
  pure function list_edge_entries(facets, f, k) result(entries)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f, k                    !< facet and edge
    integer, allocatable :: entries(:)
    integer :: start, n
    start = facets%first(f) - 1
    n = n_facet_corners(facets%kind(f))
    entries = [start + k]
    if (is_line_facet(facets%kind(f))) return
    entries = [start + k, start + modulo(k, n) + 1]
    if (facets%first(f + 1) - facets%first(f) > n) entries = [entries, start + n + k]
  end function list_edge_entries

end module amontons_master_symmetry_planes
