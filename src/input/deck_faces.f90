!> Search of element faces by corner nodes: free, shared and one-sided faces.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_faces
  use amontons_deck_reader, only: reader_type
  use amontons_containers, only: integer_list_type, list_groups, owners_of_entries
  use amontons_mesh, only: mesh_type
  use amontons_element_kinds, only: element_kind_type, element_kind, facet_kind_type, facet_kind, is_two_sided, N_KINDS
  implicit none
  private
  public :: node_elements_type, find_free_faces, find_omitted_faces, find_side_elements, count_shared_faces

  !> The elements at each node, for looking up faces.
  type :: node_elements_type
    integer, allocatable :: first(:)             !< (n_nodes + 1) start in elements; not there: not indexed yet
    integer, allocatable :: elements(:)
    type(element_kind_type), allocatable :: kinds(:)   !< (N_KINDS) table of the element kinds
  end type node_elements_type

contains

  !> Indexes the elements by their nodes, once. Cost: linear.
  subroutine index_faces(faces, mesh)
    type(node_elements_type), intent(inout) :: faces
    type(mesh_type), intent(in) :: mesh
    integer, allocatable :: owner(:)
    integer :: kind
    if (allocated(faces%first)) return
    faces%kinds = [(element_kind(kind), kind=1, N_KINDS)]
    owner = owners_of_entries(mesh%first(:mesh%n_elements + 1))
    call list_groups(mesh%nodes, mesh%n_nodes, faces%first, faces%elements)
    faces%elements = owner(faces%elements)
  end subroutine index_faces


  !> The corner nodes of a face of an element.
  pure function corner_nodes(faces, mesh, e, face) result(corners)
    type(node_elements_type), intent(in) :: faces   !< indexed
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e, face
    integer, allocatable :: corners(:)
    type(facet_kind_type) :: facet
    associate (entry => faces%kinds(mesh%kind(e)))
      facet = facet_kind(entry%face_kind(face))
      corners = mesh%nodes(mesh%first(e) - 1 + entry%face_nodes(:facet%n_corners, face))
    end associate
  end function corner_nodes


  !> The element faces with given corner nodes: their number, and the first one.
  subroutine match_face(faces, mesh, corners, n, element, face, excluded)
    type(node_elements_type), intent(in) :: faces        !< indexed
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: corners(:)
    integer, intent(out) :: n, element, face     !< 0, 0, 0 if not found
    integer, intent(in), optional :: excluded     !< element that does not count
    integer :: k, i
    n = 0
    element = 0
    face = 0
    do k = faces%first(corners(1)), faces%first(corners(1) + 1) - 1
      associate (e => faces%elements(k))
        if (present(excluded)) then
          if (e == excluded) cycle
        end if
        if (is_two_sided(mesh%kind(e))) cycle   ! it hides no face
        if (.not. has_nodes(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1), corners)) cycle
        do i = 1, faces%kinds(mesh%kind(e))%n_faces
          if (.not. has_same_corners(faces, mesh, e, i, corners)) cycle
          n = n + 1
          if (element == 0) face = i
          if (element == 0) element = e
        end do
      end associate
    end do
  end subroutine match_face


  !> Whether some nodes are all among others.
  pure logical function has_nodes(nodes, wanted)
    integer, intent(in) :: nodes(:), wanted(:)
    integer :: j
    has_nodes = .false.
    do j = 1, size(wanted)
      if (.not. any(nodes == wanted(j))) return
    end do
    has_nodes = .true.
  end function has_nodes


  !> Whether a face has given corner nodes, in any order.
  pure logical function has_same_corners(faces, mesh, e, face, corners)
    type(node_elements_type), intent(in) :: faces   !< indexed
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e, face, corners(:)
    type(facet_kind_type) :: facet
    associate (entry => faces%kinds(mesh%kind(e)))
      facet = facet_kind(entry%face_kind(face))
      has_same_corners = facet%n_corners == size(corners)
      if (has_same_corners) has_same_corners = &
        has_nodes(mesh%nodes(mesh%first(e) - 1 + entry%face_nodes(:facet%n_corners, face)), corners)
    end associate
  end function has_same_corners


  !> How many of some faces another element shares.
  integer function count_shared_faces(faces, mesh, element, face) result(n_hidden)
    type(node_elements_type), intent(inout) :: faces
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: element(:), face(:)
    integer :: i, n, e, f
    n_hidden = 0
    if (any(mesh%nodes < 1)) return
    call index_faces(faces, mesh)
    do i = 1, size(element)
      call match_face(faces, mesh, corner_nodes(faces, mesh, element(i), face(i)), n, e, f)
      if (n > 1) n_hidden = n_hidden + 1
    end do
  end function count_shared_faces


  !> The faces of some elements that no other element of the mesh shares.
  subroutine find_free_faces(faces, mesh, members, element, face)
    type(node_elements_type), intent(inout) :: faces
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: members(:)            !< elements
    integer, allocatable, intent(out) :: element(:), face(:)
    type(integer_list_type) :: elements, numbers
    integer :: i, k, n, e, f
    allocate (element(0), face(0))
    if (any(mesh%nodes < 1)) return              ! an element with a missing node: already reported
    call index_faces(faces, mesh)
    do i = 1, size(members)
      do k = 1, faces%kinds(mesh%kind(members(i)))%n_faces
        call match_face(faces, mesh, corner_nodes(faces, mesh, members(i), k), n, e, f)
        if (n /= 1 .and. .not. is_two_sided(mesh%kind(members(i)))) cycle
        call elements%add(members(i))
        call numbers%add(k)
      end do
    end do
    element = elements%trimmed()
    face = numbers%trimmed()
  end subroutine find_free_faces


  !> The element faces covered by dropped elements (faces or edges that a mesh generator wrote with the body).
  subroutine find_omitted_faces(reader, faces, mesh, members, element, face, n_without)
    type(reader_type), intent(in) :: reader
    type(node_elements_type), intent(inout) :: faces
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: members(:)            !< indices into reader%omitted_first
    integer, allocatable, intent(out) :: element(:), face(:)
    integer, intent(out) :: n_without            !< of them, that lie on no face
    type(integer_list_type) :: elements, numbers
    integer :: i, n, e, f, n_corners
    allocate (element(0), face(0))
    n_without = 0
    if (any(mesh%nodes < 1)) return              ! an element with a missing node: already reported
    call index_faces(faces, mesh)
    do i = 1, size(members)
      associate (nodes => reader%omitted_nodes(reader%omitted_first(members(i)):reader%omitted_first(members(i) + 1) - 1))
        n_corners = size(nodes)
        if (n_corners == 6 .or. n_corners == 8) n_corners = n_corners / 2
        call match_face(faces, mesh, nodes(:n_corners), n, e, f)
        if (e == 0 .and. size(nodes) == 3) call match_face(faces, mesh, nodes(:2), n, e, f)         ! a curved edge with its
        if (e == 0 .and. size(nodes) == 3) call match_face(faces, mesh, nodes(1:3:2), n, e, f)      ! middle node last or second
      end associate
      if (e == 0) then
        n_without = n_without + 1
        cycle
      end if
      call elements%add(e)
      call numbers%add(f)
    end do
    element = elements%trimmed()
    face = numbers%trimmed()
  end subroutine find_omitted_faces


  !> The elements on the side of interior faces on which the faces were named, including those that touch the faces by an
  !! edge or a corner only. The search crosses other faces with nodes of the given faces, never the given faces.
  subroutine find_side_elements(mesh, element, face, side, is_cut_through)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: element(:), face(:)   !< the given faces
    integer, allocatable, intent(out) :: side(:) !< elements
    logical, intent(out) :: is_cut_through       !< .false.: a path leads around the edge of the faces to their other side
    type(node_elements_type) :: faces
    type(integer_list_type) :: reached
    integer :: beyond(size(element)), i, k, n, other, f
    logical :: is_given(6, mesh%n_elements), is_on(mesh%n_nodes), is_reached(mesh%n_elements)
    call index_faces(faces, mesh)
    is_given = .false.
    is_on = .false.
    is_reached = .false.
    do i = 1, size(element)
      is_given(face(i), element(i)) = .true.
      is_on(corner_nodes(faces, mesh, element(i), face(i))) = .true.
      call match_face(faces, mesh, corner_nodes(faces, mesh, element(i), face(i)), n, beyond(i), f, excluded=element(i))
      if (.not. is_reached(element(i))) call reached%add(element(i))
      is_reached(element(i)) = .true.
    end do
    i = 0
    do while (i < reached%n)                     ! the list grows meanwhile
      i = i + 1
      do k = 1, faces%kinds(mesh%kind(reached%items(i)))%n_faces
        if (is_given(k, reached%items(i)) .or. .not. any(is_on(corner_nodes(faces, mesh, reached%items(i), k)))) cycle
        call match_face(faces, mesh, corner_nodes(faces, mesh, reached%items(i), k), n, other, f, excluded=reached%items(i))
        if (other == 0) cycle
        if (.not. is_reached(other)) call reached%add(other)
        is_reached(other) = .true.
      end do
    end do
    side = reached%trimmed()
    is_cut_through = .not. any(is_reached(pack(beyond, beyond > 0)))
  end subroutine find_side_elements

end module amontons_deck_faces
