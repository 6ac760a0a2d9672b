!> Model check of bodies that touch, overlap or nearly meet without a contact pair or a tie, with the cards that pair them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Two faces of different bodies *meet* if their normals oppose, their boxes are within a twentieth of an edge, or a quarter where
!! they overlap, and neither lies behind the other by more than the elements below them are deep. Bodies are *joined* if a contact
!! pair or a tie has surfaces on both, or if an equation, a multi-point constraint, a spring or the like has nodes of both, directly
!! or by nodes without a body (reference nodes).
!! Cost: linear in the faces, and pairs of bodies that meet times contact pairs.
module amontons_model_check_unpaired
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: diagnostic_list_type
  use amontons_text, only: to_text, plural, verb, NEWLINE
  use amontons_containers, only: integer_list_type, find_root, unite_trees, ascending_order, sort_integers
  use amontons_element_kinds, only: element_kind, element_kind_type
  use amontons_mesh, only: find_connected_nodes
  use amontons_model, only: model_type, n_nonlinear_mpcs, absent_elements
  use amontons_surfaces, only: surface_type
  use amontons_exterior_surface, only: exterior_type
  use amontons_facet_search, only: facet_search_type, find_near_facets
  use amontons_general_contact, only: face_data_type, side_type, build_model_exterior, collect_stiffness, add_to_side, &
    compare_sides, body_name, TOUCHING_RADIUS
  use amontons_face_proximity, only: are_near, build_face_search, is_larger
  use amontons_model_check_bodies, only: report_warning
  implicit none
  private
  public :: check_unpaired_bodies

  real(DP), parameter :: OVERLAP_RADIUS = 0.25_DP          !< TOUCHING_RADIUS for faces that lie behind each other [-]
  integer, parameter :: MAX_PAIRS_SHOWN = 5                !< pairs of bodies with cards; of the others only the number appears
  integer, parameter :: MAX_LISTED = 160                   !< faces of a surface to copy; of wider ones general contact is proposed
  integer, parameter :: LABELS_PER_LINE = 12

  !> Two bodies that meet.
  type :: touching_bodies_type
    integer :: body(2) = 0                         !< slave and master
    type(integer_list_type) :: faces(2)            !< exterior faces of each that meet the other one
    logical :: is_joined = .false.
  end type touching_bodies_type

contains

  !> Warns of bodies that meet and are not joined. Nothing is said where general contact chooses the pairs.
  subroutine check_unpaired_bodies(model, report)
    type(model_type), intent(in) :: model
    type(diagnostic_list_type), intent(inout) :: report
    type(exterior_type) :: exterior
    type(face_data_type) :: data
    type(touching_bodies_type), allocatable :: contacts(:)
    integer, allocatable :: of_node(:)
    integer :: i, n
    if (allocated(model%general_contact)) return
    call find_connected_nodes(model%mesh, of_node, n, absent_elements(model, 1))
    if (n < 2) return
    call build_model_exterior(model, 1, exterior)
    if (exterior%n_bodies < 2) return
    call collect_stiffness(model, exterior, data)
    call find_touching_bodies(exterior, data, contacts)
    if (size(contacts) == 0) return
    call number_nodes(model, exterior, of_node)
    call mark_pairs(model, of_node, contacts)
    call mark_constraints(model, of_node, contacts)
    n = 0
    do i = 1, size(contacts)
      if (contacts(i)%is_joined) cycle
      n = n + 1
      if (n <= MAX_PAIRS_SHOWN) call report_warning(report, touching_text(model, exterior, contacts(i)))
    end do
    if (n > MAX_PAIRS_SHOWN) call report_warning(report, plural(n - MAX_PAIRS_SHOWN, 'more pair') // &
      verb(n - MAX_PAIRS_SHOWN, ' of bodies meets', ' of bodies meet') // ' without a contact pair or a ' // &
      'tie. *CONTACT with *CONTACT INCLUSIONS, ALL EXTERIOR finds all pairs.')
  end subroutine check_unpaired_bodies


  !> Finds the bodies that meet, the better slave first.
  subroutine find_touching_bodies(exterior, data, contacts)
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    type(touching_bodies_type), allocatable, intent(out) :: contacts(:)
    type(integer_list_type) :: own, other
    integer, allocatable :: order(:)
    integer(I64), allocatable :: key(:)
    integer :: i, k
    allocate (contacts(0))
    call find_touching_faces(exterior, data, own, other)
    allocate (key(own%n))
    do i = 1, own%n
      associate (a => exterior%body(own%items(i)), b => exterior%body(other%items(i)))
        key(i) = int(min(a, b), I64) * int(exterior%n_bodies, I64) + int(max(a, b), I64)
      end associate
    end do
    order = ascending_order(real(key, DP))
    i = 1
    do while (i <= own%n)
      k = i
      do while (k < own%n)
        if (key(order(k + 1)) /= key(order(i))) exit
        k = k + 1
      end do
      contacts = [contacts, touching_bodies_of(exterior, data, [own%items(order(i:k)), other%items(order(i:k))])]
      i = k + 1
    end do
  end subroutine find_touching_bodies


  !> Pairs of faces that meet: each face with the larger ones of other bodies near its centre.
  subroutine find_touching_faces(exterior, data, own, other)
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    type(integer_list_type), intent(out) :: own, other
    type(facet_search_type) :: search
    integer, allocatable :: list(:)
    integer :: f, i, k, n
    call build_face_search(exterior, [(f, f=1, exterior%n)], OVERLAP_RADIUS, 0.0_DP, search)
    do f = 1, exterior%n
      call find_near_facets(search, exterior%centre(:, f), list, n)
      do k = 1, n
        i = list(k)
        if (exterior%body(i) == exterior%body(f) .or. .not. is_larger(exterior, i, f)) cycle
        if (data%is_rigid(f) .and. data%is_rigid(i)) cycle
        if (.not. (do_touch(exterior, f, i) .or. do_touch(exterior, i, f))) cycle
        call own%add(f)
        call other%add(i)
      end do
    end do
  end subroutine find_touching_faces


  !> Whether two faces of different bodies meet.
  pure logical function do_touch(exterior, f, m)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f, m                    !< faces
    real(DP) :: between(3)
    do_touch = are_near(exterior, f, m, TOUCHING_RADIUS, 0.0_DP)
    if (do_touch) return
    between = exterior%centre(:, m) - exterior%centre(:, f)
    if (dot_product(between, exterior%normal(:, f)) > 0.0_DP .or. dot_product(between, exterior%normal(:, m)) < 0.0_DP) return
    do_touch = are_near(exterior, f, m, OVERLAP_RADIUS, 0.0_DP)
  end function do_touch


  !> The two bodies of some faces: who is the better slave, and the faces of each.
  function touching_bodies_of(exterior, data, faces) result(contact)
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: faces(:)                !< of two bodies, perhaps several times
    type(touching_bodies_type) :: contact
    type(side_type) :: sides(2)
    integer, allocatable :: sorted(:)
    integer :: i, s, reason
    logical :: is_slave
    contact%body = [minval(exterior%body(faces)), maxval(exterior%body(faces))]
    sorted = faces
    call sort_integers(sorted)
    do i = 1, size(sorted)
      if (i > 1) then
        if (sorted(i) == sorted(i - 1)) cycle
      end if
      s = merge(1, 2, exterior%body(sorted(i)) == contact%body(1))
      call contact%faces(s)%add(sorted(i))
      call add_to_side(exterior, data, sorted(i), sides(s))
    end do
    sides%modulus = sides%modulus / real(sides%n, DP)
    sides%edge = sides%edge / real(sides%n, DP)
    call compare_sides(sides(1), sides(2), is_slave, reason)
    if (is_slave) return
    contact%body = contact%body(2:1:-1)
    contact%faces = contact%faces(2:1:-1)
  end function touching_bodies_of


  !> The body of each node; 0: none.
  subroutine number_nodes(model, exterior, of_node)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    integer, allocatable, intent(out) :: of_node(:)
    integer :: e
    allocate (of_node(model%mesh%n_nodes), source=0)
    do e = 1, model%mesh%n_elements
      if (exterior%body_of_element(e) == 0) cycle
      of_node(model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1)) = exterior%body_of_element(e)
    end do
  end subroutine number_nodes


  !> Marks bodies that a contact pair or a tie joins.
  subroutine mark_pairs(model, of_node, contacts)
    type(model_type), intent(in) :: model
    integer, intent(in) :: of_node(:)
    type(touching_bodies_type), intent(inout) :: contacts(:)
    integer :: p
    do p = 1, size(model%pairs)
      call mark(model%pairs(p)%slave, model%pairs(p)%master)
    end do
    if (.not. allocated(model%ties)) return
    do p = 1, size(model%ties)
      call mark(model%ties(p)%slave, model%ties(p)%master)
    end do

  contains

    !> Marks the bodies of two surfaces.
    subroutine mark(slave, master)
      integer, intent(in) :: slave, master         !< surfaces
      logical :: is_on(0:maxval(of_node), 2)
      integer :: i
      is_on = .false.
      is_on(of_node(model%surfaces(slave)%nodes), 1) = .true.
      if (.not. allocated(model%surfaces(master)%nodes)) return    ! a profile
      is_on(of_node(model%surfaces(master)%nodes), 2) = .true.
      do i = 1, size(contacts)
        associate (a => contacts(i)%body(1), b => contacts(i)%body(2))
          if ((is_on(a, 1) .and. is_on(b, 2)) .or. (is_on(b, 1) .and. is_on(a, 2))) contacts(i)%is_joined = .true.
        end associate
      end do
    end subroutine mark

  end subroutine mark_pairs


  !> Marks bodies that have nodes in one equation, multi-point constraint or element without faces, or in several that share nodes
  !! without a body.
  subroutine mark_constraints(model, of_node, contacts)
    type(model_type), intent(in) :: model
    integer, intent(in) :: of_node(:)
    type(touching_bodies_type), intent(inout) :: contacts(:)
    type(element_kind_type) :: kind
    integer, allocatable :: parent(:)              ! trees of bodyless nodes, then of the constraints themselves
    type(integer_list_type) :: tree, body
    integer :: i, n
    n = size(model%equations) + n_nonlinear_mpcs(model) + model%mesh%n_elements
    parent = [(i, i=1, size(of_node) + n)]
    n = size(of_node)
    do i = 1, size(model%equations)
      call join(model%equations(i)%node)
    end do
    do i = 1, n_nonlinear_mpcs(model)
      call join(model%nonlinear_mpcs(i)%node)
    end do
    do i = 1, model%mesh%n_elements
      kind = element_kind(model%mesh%kind(i))
      if (kind%n_faces == 0) call join(model%mesh%nodes(model%mesh%first(i):model%mesh%first(i + 1) - 1))
    end do
    call mark_trees(parent, tree, body, contacts)

  contains

    !> One constraint: it unites its nodes without a body, and notes its bodies.
    subroutine join(nodes)
      integer, intent(in) :: nodes(:)
      integer :: k
      n = n + 1
      do k = 1, size(nodes)
        if (of_node(nodes(k)) == 0) then
          call unite_trees(parent, n, nodes(k))
        else
          call tree%add(n)
          call body%add(of_node(nodes(k)))
        end if
      end do
    end subroutine join

  end subroutine mark_constraints


  !> Marks the contacts of bodies that are in one tree.
  subroutine mark_trees(parent, tree, body, contacts)
    integer, intent(inout) :: parent(:)
    type(integer_list_type), intent(in) :: tree, body   !< in the tree of item i is body i
    type(touching_bodies_type), intent(inout) :: contacts(:)
    type(integer_list_type), allocatable :: trees_of(:)
    integer :: i, b, k
    b = 0
    do i = 1, size(contacts)
      b = max(b, maxval(contacts(i)%body))
    end do
    do i = 1, body%n
      b = max(b, body%items(i))
    end do
    allocate (trees_of(b))
    do i = 1, body%n
      k = find_root(parent, tree%items(i))
      associate (list => trees_of(body%items(i)))
        if (list%n > 0) then
          if (list%items(list%n) == k) cycle
        end if
        call list%add(k)
      end associate
    end do
    do i = 1, size(contacts)
      associate (a => trees_of(contacts(i)%body(1)), c => trees_of(contacts(i)%body(2)))
        if (a%n > 0 .and. c%n > 0) contacts(i)%is_joined = contacts(i)%is_joined .or. have_common(a%trimmed(), c%trimmed())
      end associate
    end do
  end subroutine mark_trees


  !> Whether two lists have a common item.
  logical function have_common(a, b)
    integer, intent(in) :: a(:), b(:)
    integer, allocatable :: own(:), other(:)
    integer :: i, k
    own = a
    call sort_integers(own)
    other = b
    call sort_integers(other)
    have_common = .false.
    i = 1
    k = 1
    do while (i <= size(own) .and. k <= size(other))
      have_common = own(i) == other(k)
      if (have_common) return
      if (own(i) < other(k)) then
        i = i + 1
      else
        k = k + 1
      end if
    end do
  end function have_common


  !> The warning, with cards to copy.
  function touching_text(model, exterior, contact) result(text)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(touching_bodies_type), intent(in) :: contact
    character(:), allocatable :: text
    character(:), allocatable :: name, slave, master, cards
    integer :: s
    cards = ''
    do s = 1, 2
      call surface_cards(model, exterior, contact%body(s), contact%faces(s)%trimmed(), name, cards)
      if (s == 1) slave = name
      if (s == 2) master = name
    end do
    text = 'The bodies ' // body_name(model, exterior, contact%body(1)) // ' (element ' // &
      to_text(model%mesh%element_label(exterior%element(contact%faces(1)%items(1)))) // ') and ' // &
      body_name(model, exterior, contact%body(2)) // ' (element ' // &
      to_text(model%mesh%element_label(exterior%element(contact%faces(2)%items(1)))) // &
      ') touch, overlap or nearly meet, but no contact pair and no tie joins them: they can pass through each other. '
    text = text // 'If they are to touch, copy these cards before the first step; a *TIE of their surfaces bonds them.'
    if (slave == '' .or. master == '') then
      text = text // NEWLINE // '*CONTACT' // NEWLINE // '*CONTACT INCLUSIONS, ALL EXTERIOR'
      return
    end if
    if (size(model%interactions) > 0) then
      name = model%interactions(1)%name
    else
      name = 'TOUCH'
      cards = cards // NEWLINE // '*SURFACE INTERACTION, NAME=TOUCH' // NEWLINE // '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD'
    end if
    text = text // cards // NEWLINE // '*CONTACT PAIR, INTERACTION=' // name // ', TYPE=SURFACE TO SURFACE' // NEWLINE // slave // &
      ', ' // master
  end function touching_text


  !> The name of a surface that has the faces: the smallest of the deck, or a new one, whose cards are appended.
  subroutine surface_cards(model, exterior, body, faces, name, cards)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: body
    integer, intent(in) :: faces(:)
    character(:), allocatable, intent(out) :: name     !< '': too many faces, or some are of shells
    character(:), allocatable, intent(inout) :: cards
    character(:), allocatable :: lines
    integer, allocatable :: wider(:), members(:)
    integer :: s, best, k
    best = 0
    do s = 1, size(model%surfaces)
      if (.not. has_faces(model%surfaces(s), exterior, faces)) cycle
      if (best > 0) then
        if (size(model%surfaces(best)%face) <= size(model%surfaces(s)%face)) cycle
      end if
      best = s
    end do
    name = ''
    if (best > 0) name = model%surfaces(best)%name
    if (best > 0 .or. has_structure(model, exterior%element(faces))) return
    wider = faces_around(exterior, model%mesh%n_nodes, faces)
    if (size(wider) > MAX_LISTED) return
    name = body_name(model, exterior, body)
    lines = NEWLINE // '*SURFACE, NAME=' // name // '_FACES'
    do k = 1, maxval(exterior%face(wider))
      members = pack(exterior%element(wider), exterior%face(wider) == k)
      if (size(members) == 0) cycle
      cards = cards // NEWLINE // '*ELSET, ELSET=' // name // '_S' // to_text(k) // &
        label_lines(model%mesh%element_label(members))
      lines = lines // NEWLINE // name // '_S' // to_text(k) // ', S' // to_text(k)
    end do
    cards = cards // lines
    name = name // '_FACES'
  end subroutine surface_cards


  !> Some faces and those of their patches that share a node with them, so that they reach beyond what meets.
  pure function faces_around(exterior, n_nodes, faces) result(wider)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: n_nodes
    integer, intent(in) :: faces(:)
    integer, allocatable :: wider(:)
    logical :: is_on(n_nodes), is_patch(exterior%n_patches), is_in(exterior%n)
    integer :: i, f
    is_on = .false.
    is_patch = .false.
    is_patch(exterior%patch(faces)) = .true.
    do i = 1, size(faces)
      is_on(exterior%nodes(exterior%first(faces(i)):exterior%first(faces(i) + 1) - 1)) = .true.
    end do
    do f = 1, exterior%n
      is_in(f) = is_patch(exterior%patch(f)) .and. any(is_on(exterior%nodes(exterior%first(f):exterior%first(f + 1) - 1)))
    end do
    is_in(faces) = .true.
    wider = pack([(f, f=1, exterior%n)], is_in)
  end function faces_around


  !> Labels as the data lines of a set, each with a line break before it.
  pure function label_lines(labels) result(lines)
    integer, intent(in) :: labels(:)
    character(:), allocatable :: lines
    integer :: i
    lines = ''
    do i = 1, size(labels)
      if (modulo(i, LABELS_PER_LINE) == 1) lines = lines // NEWLINE // to_text(labels(i))
      if (modulo(i, LABELS_PER_LINE) /= 1) lines = lines // ', ' // to_text(labels(i))
    end do
  end function label_lines


  !> Whether a surface of element faces has all of some exterior faces.
  logical function has_faces(surface, exterior, faces)
    type(surface_type), intent(in) :: surface
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: faces(:)
    integer :: i
    has_faces = .not. (surface%is_node_based .or. allocated(surface%profile))
    if (has_faces) has_faces = size(surface%face) >= size(faces)
    do i = 1, size(faces)
      if (.not. has_faces) return
      has_faces = any(surface%element == exterior%element(faces(i)) .and. surface%face == exterior%face(faces(i)))
    end do
  end function has_faces


  !> Whether some element is a shell, a membrane or a beam of the deck, whose faces have other names.
  pure logical function has_structure(model, elements)
    type(model_type), intent(in) :: model
    integer, intent(in) :: elements(:)
    has_structure = .false.
    if (allocated(model%structure)) has_structure = any(model%structure%section(elements) > 0)
  end function has_structure

end module amontons_model_check_unpaired
