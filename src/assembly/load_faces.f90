!> Load faces: the places at which the load on a face of an element acts, and the nodes of the mesh that share it.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A load on a side of a shell acts at the reference surface, where the nodes of the deck are: on the face of its solid it would
!! have the area of that face and bend the shell by half its thickness. In the calculix dialect it acts on the face, as in CalculiX.
!! A place is a mean of nodes, x_a = sum W_ia x_i; of a face of a solid it is a node. A load with the virtual work
!! sum f_a . dx_a has the nodal forces W f, and the stiffness W k W' if k is that of f over the places.
module amontons_load_faces
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: element_kind, element_kind_type, FAMILY_SHELL, MAX_ELEMENT_NODES, MAX_FACE_NODES
  use amontons_mesh, only: mesh_type, element_nodes
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_structural_data, only: structure_type, director_type, layer_weights, n_section_layers
  implicit none
  private
  public :: load_face_type, find_load_face, add_face_force, spread_stiffness

  !> The places of a face, in the order of its nodes.
  type :: load_face_type
    integer :: kind = 0                            !< FACET_...
    integer :: n_places = 0
    integer :: element = 0                         !< of the nodes that share the load: of layers perhaps another than e
    integer :: n_nodes = 0                         !< of them
    integer :: local(MAX_ELEMENT_NODES) = 0        !< (n_nodes) their numbers in the element
    integer :: nodes(MAX_ELEMENT_NODES) = 0        !< (n_nodes) the nodes of the mesh
    logical :: is_at_reference = .false.           !< on the reference surface of a shell; else the places are the nodes
    real(DP) :: weight(MAX_ELEMENT_NODES, MAX_FACE_NODES) = 0   !< (n_nodes, n_places) W; set on the reference surface [-]
    real(DP) :: X(3, MAX_FACE_NODES) = 0           !< (3, n_places) reference places [length]
    real(DP) :: u(3, MAX_FACE_NODES) = 0           !< (3, n_places) their displacements [length]
  end type load_face_type

contains

  !> The places of a face of an element, displaced by u.
  pure subroutine find_load_face(model, e, face, u, place)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e, face                 !< element, number of its face
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) of the mesh [length]
    type(load_face_type), intent(out) :: place
    type(element_kind_type) :: kind
    integer :: nodes(MAX_ELEMENT_NODES), fibre(MAX_FACE_NODES), n, a
    kind = element_kind(model%mesh%kind(e))
    call element_nodes(model%mesh, e, n, nodes)
    n = count(kind%face_nodes(:, face) > 0)
    place%kind = kind%face_kind(face)
    place%n_places = n
    place%n_nodes = n
    place%element = e
    place%local(:n) = kind%face_nodes(:n, face)
    place%nodes(:n) = nodes(place%local(:n))
    fibre(:n) = 0
    if (allocated(model%structure) .and. model%dialect /= DIALECT_CALCULIX) &
      fibre(:n) = fibres_of_side(model%structure, e, place%nodes(:n))
    if (n > 0) place%is_at_reference = fibre(1) > 0
    if (.not. place%is_at_reference) then
      place%X(:, :n) = model%mesh%coordinates(:, place%nodes(:n))
      place%u(:, :n) = u(:, place%nodes(:n))
      return
    end if
    call share_among_fibres(model%mesh, model%structure, fibre(:n), place)
    do a = 1, n
      place%X(:, a) = model%mesh%coordinates(:, model%structure%directors(fibre(a))%node)
    end do
    place%u(:, :n) = matmul(u(:, place%nodes(:place%n_nodes)), place%weight(:place%n_nodes, :n))
  end subroutine find_load_face


  !> The fibres that end at the nodes of a face, each at one: the face is a side of a shell. All 0: it is another face, like the
  !! edge of a shell, where a fibre has both of its ends.
  pure function fibres_of_side(structure, e, nodes) result(fibre)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: e                       !< element of the mesh
    integer, intent(in) :: nodes(:)                !< of the face
    integer :: fibre(size(nodes)), a, k
    fibre = 0
    if (structure%section(e) == 0) return
    if (structure%sections(structure%section(e))%family /= FAMILY_SHELL) return
    associate (of => structure%director_of(structure%first(e):structure%first(e + 1) - 1))
      do k = 1, size(of)
        if (of(k) == 0) cycle
        do a = 1, size(nodes)
          if (any(structure%directors(of(k))%nodes(:2) == nodes(a))) fibre(a) = of(k)
        end do
      end do
    end associate
    if (any(fibre == 0) .or. any([(count(fibre == fibre(a)) > 1, a=1, size(nodes))])) fibre = 0
  end function fibres_of_side


  !> The nodes that share loads at the nodes of fibres: those at the bottom and the top of the layer where the reference surface is,
  !! linearly. Middles of quadratic elements take no share: it would pull them against the nodes above and below.
  pure subroutine share_among_fibres(mesh, structure, fibre, place)
    type(mesh_type), intent(in) :: mesh
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: fibre(:)                !< indices into the directors
    type(load_face_type), intent(inout) :: place   !< in: element; out: nodes and weights
    integer :: nodes(MAX_ELEMENT_NODES), n, a, e, first
    logical :: is_whole
    first = place%element + 1 - mesh%layer(place%element)
    do e = first, first - 1 + n_section_layers(structure%sections(structure%section(first)))
      call element_nodes(mesh, e, n, nodes)
      place%element = e
      place%n_nodes = 0
      is_whole = .true.                            ! all nodes are of this layer
      do a = 1, size(fibre)
        call share_by_fibre(structure%directors(fibre(a)), a, nodes(:n), place, is_whole)
      end do
      if (is_whole) return
    end do
  end subroutine share_among_fibres


  !> Adds the nodes of one fibre that an element has.
  pure subroutine share_by_fibre(director, a, nodes, place, is_whole)
    type(director_type), intent(in) :: director
    integer, intent(in) :: a                       !< the place at its node
    integer, intent(in) :: nodes(:)                !< of the element
    type(load_face_type), intent(inout) :: place
    logical, intent(inout) :: is_whole             !< .false.: the element lacks a node that shares the load
    real(DP) :: share(size(director%nodes))
    integer :: i, k
    share = layer_weights(director, director%offset(1))
    place%weight(:, a) = 0
    do i = 1, size(share)
      if (.not. abs(share(i)) > 0) cycle
      k = findloc(nodes, director%nodes(i), dim=1)
      is_whole = is_whole .and. k > 0
      if (k == 0) cycle
      place%n_nodes = place%n_nodes + 1
      place%local(place%n_nodes) = k
      place%nodes(place%n_nodes) = nodes(k)
      place%weight(place%n_nodes, a) = share(i)
    end do
  end subroutine share_by_fibre


  !> Adds the nodal forces W f of forces at the places.
  pure subroutine add_face_force(place, force, applied_force)
    type(load_face_type), intent(in) :: place
    real(DP), intent(in) :: force(:, :)            !< (3, >= n_places) f [force]
    real(DP), intent(inout) :: applied_force(:, :)   !< (3, n_nodes) of the mesh [force]
    integer :: a, i
    do a = 1, place%n_places
      if (.not. place%is_at_reference) then
        applied_force(:, place%nodes(a)) = applied_force(:, place%nodes(a)) + force(:, a)
        cycle
      end if
      do i = 1, place%n_nodes
        applied_force(:, place%nodes(i)) = applied_force(:, place%nodes(i)) + place%weight(i, a) * force(:, a)
      end do
    end do
  end subroutine add_face_force


  !> The stiffness W k W' of the nodes of a face from that of its places.
  pure function spread_stiffness(place, stiffness) result(spread_out)
    type(load_face_type), intent(in) :: place
    real(DP), intent(in) :: stiffness(:, :)        !< (>= 3 n_places, >= 3 n_places) k [force/length]
    real(DP) :: spread_out(3 * place%n_nodes, 3 * place%n_nodes)   !< [force/length]
    real(DP) :: half(3 * place%n_nodes, 3 * place%n_places)   ! W k
    integer :: i, a
    if (.not. place%is_at_reference) then
      spread_out = stiffness(:3 * place%n_places, :3 * place%n_places)
      return
    end if
    half = 0
    spread_out = 0
    do a = 1, place%n_places
      do i = 1, place%n_nodes
        half(3 * i - 2:3 * i, :) = half(3 * i - 2:3 * i, :) + place%weight(i, a) * stiffness(3 * a - 2:3 * a, :3 * place%n_places)
      end do
    end do
    do a = 1, place%n_places
      do i = 1, place%n_nodes
        spread_out(:, 3 * i - 2:3 * i) = spread_out(:, 3 * i - 2:3 * i) + place%weight(i, a) * half(:, 3 * a - 2:3 * a)
      end do
    end do
  end function spread_stiffness

end module amontons_load_faces
