!> Elements of a deck with repeated nodes: hexahedra that are wedges or tetrahedra, quadrilaterals that are triangles.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Mesh generators write a triangle as a quadrilateral with two equal corners, a wedge as a hexahedron in which two edges of one
!! face are points. Where corners 3 and 4 of a bilinear quadrilateral are equal, N1, N2 and N3 + N4 have the sum 1 and map onto the
!! coordinates: they are the area coordinates of the triangle. So the interpolation of such an element is that of the triangle,
!! the wedge or the tetrahedron, whose kind it gets. Faces and edges keep the numbers of the deck (mesh%face_places).
module amontons_deck_collapsed_elements
  use amontons_containers, only: integer_list_type
  use amontons_deck_reader, only: reader_type, report_error, report_note
  use amontons_element_drafts, only: element_draft_type
  use amontons_element_kinds, only: element_kind, element_kind_type, element_kind_by_name, KIND_USER, N_DECK_KINDS, &
    MAX_ELEMENT_NODES, FAMILY_PLANE_STRESS, FAMILY_PLANE_STRAIN, FAMILY_AXISYMMETRIC, FAMILY_SHELL, FAMILY_MEMBRANE
  use amontons_mesh, only: mesh_type, N_NUMBERED_FACES
  use amontons_text, only: plural, to_text, verb
  implicit none
  private
  public :: collapse_elements

  integer, parameter :: EDGES(2, 12) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 5, 6, 6, 7, 7, 8, 8, 5, 1, 5, 2, 6, 3, 7, 4, 8], [2, 12]) !<
  !! corners of the edges of a hexahedron, in the order of its nodes between corners; the first four are those of a quadrilateral
  integer, parameter :: SIDES(4, 6) = reshape([1, 2, 3, 4, 5, 8, 7, 6, 1, 5, 6, 2, 2, 6, 7, 3, 3, 7, 8, 4, 4, 8, 5, 1], [4, 6]) !<
  !! corners of its faces, as seen from inside

  !> What an element becomes.
  type :: collapsed_type
    integer :: kind = 0                            !< KIND_..., 0: none
    integer :: n = 0                               !< nodes
    integer :: nodes(MAX_ELEMENT_NODES) = 0
    integer :: places(N_NUMBERED_FACES) = 0        !< number of each face or edge there, 0: it is a line or a point
  end type collapsed_type

contains

  !> Gives elements with repeated nodes the kind with fewer nodes that they are, and reports the others. Cost: linear.
  subroutine collapse_elements(reader, mesh, draft)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh            !< nodes
    type(element_draft_type), intent(inout) :: draft
    type(collapsed_type) :: collapsed
    type(integer_list_type) :: nodes
    integer :: of_kind(3, N_DECK_KINDS)                 ! number of those that are collapsed, the first one, its new kind
    integer, allocatable :: first(:)
    integer :: e, repeated, kind, i
    if (.not. any([(repeated_node(draft, e) > 0, e=1, draft%n)])) return
    of_kind = 0
    first = draft%first
    do e = 1, draft%n
      repeated = repeated_node(draft, e)
      kind = draft%kind(e)
      collapsed = collapsed_type()
      associate (old => draft%nodes%items(draft%first(e):draft%first(e + 1) - 1))
        if (repeated > 0) call collapse(kind, old, collapsed)
        if (collapsed%kind == 0) call append(nodes, old)
      end associate
      if (collapsed%kind > 0) then
        if (.not. allocated(draft%face_places)) allocate (draft%face_places(N_NUMBERED_FACES, draft%n), &
          source=spread([(i, i=1, N_NUMBERED_FACES)], 2, draft%n))
        draft%face_places(:, e) = collapsed%places
        draft%kind(e) = collapsed%kind
        call append(nodes, collapsed%nodes(:collapsed%n))
        of_kind(1, kind) = of_kind(1, kind) + 1
        if (of_kind(1, kind) == 1) of_kind(2:, kind) = [e, collapsed%kind]
      else if (repeated > 0) then
        call report_error(reader, draft%line(e), 'The element ' // to_text(draft%label(e)) // ' is degenerate: node ' // &
          to_text(mesh%node_label(repeated)) // ' appears twice. A quadrilateral may be a triangle, a hexahedron a wedge or a ' // &
          'tetrahedron, with the nodes between their corners; nothing else.')
      end if
      first(e + 1) = nodes%n + 1
    end do
    draft%first = first
    draft%nodes = nodes
    do kind = 1, N_DECK_KINDS
      if (of_kind(1, kind) > 0) call report_collapsed(reader, draft, kind, of_kind(:, kind))
    end do
  end subroutine collapse_elements


  !> Says what the elements of a kind became.
  subroutine report_collapsed(reader, draft, kind, of_kind)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    integer, intent(in) :: kind                    !< KIND_... in the deck
    integer, intent(in) :: of_kind(3)              !< number, first element, its new kind
    type(element_kind_type) :: before, after
    before = element_kind(kind)
    after = element_kind(of_kind(3))
    call report_note(reader, draft%line(of_kind(2)), plural(of_kind(1), 'element') // ' ' // trim(before%name) // ' ' // &
      verb(of_kind(1), 'has', 'have') // ' repeated nodes: triangles, wedges or tetrahedra, taken as such. The first, ' // &
      to_text(draft%label(of_kind(2))) // ', is taken as ' // trim(after%name) // '.')
  end subroutine report_collapsed


  !> A node that an element has twice; 0: none. The nodes of a user element may repeat.
  pure integer function repeated_node(draft, e) result(node)
    type(element_draft_type), intent(in) :: draft
    integer, intent(in) :: e
    integer :: i
    node = 0
    if (draft%kind(e) == 0 .or. draft%kind(e) == KIND_USER) return
    do i = draft%first(e) + 1, draft%first(e + 1) - 1
      node = draft%nodes%items(i)
      if (node > 0 .and. any(draft%nodes%items(draft%first(e):i - 1) == node)) return
    end do
    node = 0
  end function repeated_node


  !> Appends numbers to a list.
  subroutine append(list, numbers)
    type(integer_list_type), intent(inout) :: list
    integer, intent(in) :: numbers(:)
    integer :: i
    do i = 1, size(numbers)
      call list%add(numbers(i))
    end do
  end subroutine append


  !> The element without repeated nodes.
  pure subroutine collapse(kind, nodes, collapsed)
    integer, intent(in) :: kind                    !< KIND_... in the deck
    integer, intent(in) :: nodes(:)
    type(collapsed_type), intent(out) :: collapsed
    type(element_kind_type) :: entry
    logical :: is_layered
    integer :: side, spin, turned(8)
    entry = element_kind(kind)
    if (any(entry%family == [FAMILY_PLANE_STRESS, FAMILY_PLANE_STRAIN, FAMILY_AXISYMMETRIC, FAMILY_SHELL, FAMILY_MEMBRANE])) then
      if (size(nodes) /= 4 .and. size(nodes) /= 8) return
      do spin = 0, 3
        turned(:4) = cshift([1, 2, 3, 4], spin)
        call try_shape(nodes, EDGES(:, :4), turned([1, 2, 3]), turned([3, 4]), kind_with(entry%name, 3), collapsed)
        if (collapsed%kind > 0) return
      end do
      return
    end if
    if (size(nodes) /= 8 .and. size(nodes) /= 20) return
    is_layered = entry%name(:3) == 'CSS' .or. entry%name(:3) == 'COH'   ! the direction of their layers stays
    do side = 1, merge(1, 6, is_layered)
      do spin = 0, 3
        turned(:4) = cshift(SIDES(:, side), spin)
        turned(5:) = [opposite_end(turned(1)), opposite_end(turned(2)), opposite_end(turned(3)), opposite_end(turned(4))]
        call try_shape(nodes, EDGES, turned([1, 2, 3, 5, 6, 7]), turned([3, 4, 7, 8]), kind_with(entry%name, 6), collapsed)
        if (collapsed%kind == 0 .and. .not. is_layered) call try_shape(nodes, EDGES, turned([1, 2, 3, 5]), &
          turned([3, 4, 5, 6, 5, 7, 5, 8]), kind_with(entry%name, 4), collapsed)
        if (collapsed%kind > 0) return
      end do
    end do

  contains

    !> The corner on the edge that leads away from the side at a corner.
    pure integer function opposite_end(corner) result(other)
      integer, intent(in) :: corner
      integer :: i
      other = 0
      do i = 1, 12
        if (.not. any(EDGES(:, i) == corner)) cycle
        other = sum(EDGES(:, i)) - corner
        if (.not. any(turned(:4) == other)) return
      end do
    end function opposite_end

  end subroutine collapse


  !> The kind with other corners: its name has another last number. 0: there is none.
  pure integer function kind_with(name, n_corners) result(kind)
    character(*), intent(in) :: name               !< of a quadrilateral or hexahedron
    integer, intent(in) :: n_corners               !< 3; 6, 4
    integer, parameter :: QUADRATIC(3:6) = [6, 10, 0, 15]
    logical :: is_quadratic
    integer :: last
    last = scan(name, '48', back=.true.)
    is_quadratic = n_corners == 3 .and. name(max(1, last):max(1, last)) == '8'
    if (name(:min(5, len(name))) == 'C3D20') then
      is_quadratic = .true.
      last = 4
    end if
    kind = element_kind_by_name(name(:last - 1) // to_text(merge(QUADRATIC(n_corners), n_corners, is_quadratic)))
  end function kind_with


  !> Takes a shape if the element has it: some corners are different, pairs of others are equal, and nodes between equal corners, or
  !! on edges that become one, are equal, too.
  pure subroutine try_shape(nodes, edges_here, corners, equal, kind, collapsed)
    integer, intent(in) :: nodes(:)                !< of the element
    integer, intent(in) :: edges_here(:, :)        !< (2, :) corners of its edges
    integer, intent(in) :: corners(:)              !< those that stay, in the order of the new kind
    integer, intent(in) :: equal(:)                !< pairs of corners
    integer, intent(in) :: kind                    !< the new kind
    type(collapsed_type), intent(inout) :: collapsed   !< out: set if the element has this shape
    type(element_kind_type) :: entry
    integer :: i, f, g, m, a(2), n_corners
    if (kind == 0) return
    if (any(nodes(equal(1::2)) /= nodes(equal(2::2)))) return
    m = size(corners)
    if (any([(any(nodes(corners(i + 1:)) == nodes(corners(i))), i=1, m)])) return
    entry = element_kind(kind)
    n_corners = merge(4, 8, size(edges_here, 2) == 4)
    collapsed = collapsed_type(kind=kind, n=entry%n_nodes)
    collapsed%nodes(:m) = nodes(corners)
    if (size(nodes) > n_corners) then
      do i = 1, size(edges_here, 2)
        a = nodes(edges_here(:, i))
        f = n_corners + i
        if (a(1) == a(2)) then
          if (nodes(f) /= a(1)) collapsed%kind = 0
          cycle
        end if
        g = between(collapsed%nodes(:m), a)
        if (collapsed%nodes(g) /= 0 .and. collapsed%nodes(g) /= nodes(f)) collapsed%kind = 0
        collapsed%nodes(g) = nodes(f)
      end do
      do i = 1, entry%n_nodes
        if (any(collapsed%nodes(:i - 1) == collapsed%nodes(i))) collapsed%kind = 0
      end do
    end if
    collapsed%places = 0
    if (n_corners == 4) then
      do i = 1, 4
        a = nodes(edges_here(:, i))
        if (a(1) /= a(2)) collapsed%places(i) = between(collapsed%nodes(:m), a) - m
      end do
      return
    end if
    do f = 1, 6
      do g = 1, entry%n_faces
        if (is_same_face(nodes(SIDES(:, f)), collapsed%nodes(pack(entry%face_nodes(:, g), entry%face_nodes(:, g) > 0 .and. &
          entry%face_nodes(:, g) <= m)))) collapsed%places(f) = g
      end do
    end do
  end subroutine try_shape


  !> The place of the node between two corners of a triangle, tetrahedron or wedge of second order.
  pure integer function between(corners, ends) result(place)
    integer, intent(in) :: corners(:)              !< three, four or six nodes
    integer, intent(in) :: ends(2)                 !< nodes
    integer, parameter :: OF_TRIANGLE(2, 3) = reshape([1, 2, 2, 3, 3, 1], [2, 3])
    integer, parameter :: OF_TETRAHEDRON(2, 6) = reshape([1, 2, 2, 3, 3, 1, 1, 4, 2, 4, 3, 4], [2, 6])
    integer, parameter :: OF_WEDGE(2, 9) = reshape([1, 2, 2, 3, 3, 1, 4, 5, 5, 6, 6, 4, 1, 4, 2, 5, 3, 6], [2, 9])
    integer, allocatable :: pairs(:, :)
    integer :: i
    pairs = OF_TRIANGLE
    if (size(corners) == 4) pairs = OF_TETRAHEDRON
    if (size(corners) == 6) pairs = OF_WEDGE
    place = 0
    do i = 1, size(pairs, 2)
      if (all(corners(pairs(:, i)) == ends) .or. all(corners(pairs(:, i)) == ends([2, 1]))) place = size(corners) + i
    end do
  end function between


  !> Whether a face with repeated corners has just the corners of another one, at least three.
  pure logical function is_same_face(side, face)
    integer, intent(in) :: side(4)                 !< nodes
    integer, intent(in) :: face(:)
    integer :: i
    is_same_face = all([(any(face == side(i)), i=1, 4)]) .and. all([(any(side == face(i)), i=1, size(face))])
  end function is_same_face

end module amontons_deck_collapsed_elements
