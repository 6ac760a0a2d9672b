!> Self contact within general contact: bodies whose faces can meet other faces of the same body.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Two faces of a body *face each other* if their normals oppose and each is in front of the other, as across a slot. The pair of a
!! body has the faces that face each other within the way that the nodes can move in the steps, and an edge more; of a body that
!! folds (amontons_body_motion) it has all faces. One pair for each body has these faces, as slave and as master
!! (amontons_self_contact_visibility).
!!
!! Faces that met against this estimate are found after each increment (amontons_unpaired_contact).
module amontons_self_contact_pairs
  use amontons_kinds, only: DP
  use amontons_text, only: plural, NEWLINE
  use amontons_model, only: model_type
  use amontons_element_kinds, only: has_midsides
  use amontons_surfaces, only: surface_type, contact_pair_type, is_compliant
  use amontons_exterior_surface, only: exterior_type
  use amontons_mortar_segmentation, only: MIN_FACING_COSINE
  use amontons_general_contact, only: general_pairs_type, face_data_type, build_model_exterior, collect_face_data, &
    find_interaction, make_surface, body_name
  implicit none
  private
  public :: add_self_pairs, self_contact_obstacle

  integer, parameter :: MAX_COMPARED_FACES = 2000           !< faces of a body that each of its faces is compared with

contains

  !> Adds the pairs of bodies that may touch themselves, and a line for each to the text.
  subroutine add_self_pairs(model, found, text)
    type(model_type), intent(in) :: model
    type(general_pairs_type), intent(inout) :: found
    character(:), allocatable, intent(inout) :: text
    type(exterior_type) :: exterior
    type(face_data_type) :: data
    integer, allocatable :: own(:), interaction(:)
    integer :: b, f, i
    if (.not. allocated(model%general_contact)) return
    call build_model_exterior(model, 1, exterior)
    call collect_face_data(model, exterior, data)
    do b = 1, exterior%n_bodies
      own = pack([(f, f=1, exterior%n)], exterior%body == b .and. .not. data%is_rigid)
      if (size(own) == 0) cycle
      if (data%folds(b)) then
        interaction = [(find_interaction(model%general_contact, data, data%group(own(i)), data%group(own(i)), 0), i=1, size(own))]
      else
        call find_facing_faces(model, exterior, data, own, data%motion, interaction)
      end if
      do while (any(interaction > 0))
        call append_self_pair(model, exterior, data, own, interaction, found, text)
      end do
    end do
  end subroutine add_self_pairs


  !> The interaction of each face of a body with a face that it faces; 0: it faces none.
  subroutine find_facing_faces(model, exterior, data, own, motion, interaction)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: own(:)                  !< faces of the body
    real(DP), intent(in) :: motion                 !< [length]
    integer, allocatable, intent(out) :: interaction(:)   !< of the faces of the body
    integer :: i, k, stride
    allocate (interaction(size(own)), source=0)
    stride = 1 + size(own) / MAX_COMPARED_FACES
    do i = 1, size(own)
      do k = 1 + modulo(i, stride), size(own), stride
        if (.not. face_each_other(exterior, own(i), own(k), motion)) cycle
        interaction(i) = find_interaction(model%general_contact, data, data%group(own(i)), data%group(own(k)), 0)
        if (interaction(i) > 0) exit
      end do
    end do
  end subroutine find_facing_faces


  !> Whether two faces face each other within the motion and an edge.
  pure logical function face_each_other(exterior, f, m, motion)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f, m                    !< faces
    real(DP), intent(in) :: motion                 !< [length]
    real(DP) :: between(3), edge
    face_each_other = .false.
    if (dot_product(exterior%normal(:, f), exterior%normal(:, m)) > -MIN_FACING_COSINE) return
    edge = max(exterior%edge_length(f), exterior%edge_length(m))
    between = max(0.0_DP, exterior%box(:, 1, m) - exterior%box(:, 2, f), exterior%box(:, 1, f) - exterior%box(:, 2, m))
    if (norm2(between) > motion + edge) return
    between = exterior%centre(:, m) - exterior%centre(:, f)
    face_each_other = min(dot_product(between, exterior%normal(:, f)), -dot_product(between, exterior%normal(:, m))) > 0.0_DP
  end function face_each_other


  !> Appends the pair of the faces with the first interaction that is left, and removes them from the list.
  subroutine append_self_pair(model, exterior, data, own, interaction, found, text)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: own(:)                  !< faces of the body
    integer, intent(inout) :: interaction(:)       !< of each; 0: none is left
    type(general_pairs_type), intent(inout) :: found
    character(:), allocatable, intent(inout) :: text
    type(contact_pair_type) :: pair
    type(surface_type) :: surface
    character(:), allocatable :: obstacle
    logical :: is_lifted
    integer :: law
    law = interaction(findloc(interaction > 0, .true., dim=1))
    call make_surface(model, exterior, data, pack(own, interaction == law), surface)
    surface%name = body_name(model, exterior, exterior%body(own(1))) // '#SELF'
    is_lifted = any(abs(exterior%height(pack(own, interaction == law))) > 0.0_DP)
    where (interaction == law) interaction = 0
    text = text // NEWLINE // '  ' // surface%name // ' (' // plural(size(surface%face), 'face') // ')'
    obstacle = self_contact_obstacle(model, surface%element, law)
    if (obstacle /= '') then
      text = text // ' may touch itself, but has no pair for that: ' // obstacle
      return
    end if
    if (is_lifted) then
      text = text // ' may touch itself, but has no pair for that: its faces have another thickness or place by *SURFACE ' // &
        'PROPERTY ASSIGNMENT. Name two surfaces with *CONTACT PAIR, or leave them out of the assignment.'
      return
    end if
    found%surfaces = [found%surfaces, surface]
    pair%is_general = .true.
    pair%is_mortar = model%general_contact%is_mortar
    pair%interaction = law
    pair%slave = size(model%surfaces) + size(found%surfaces)
    pair%master = pair%slave
    pair%name = surface%name // ' / ' // surface%name
    found%pairs = [found%pairs, pair]
    text = text // ' touches itself, interaction ' // model%interactions(law)%name // '.'
  end subroutine append_self_pair


  !> Why elements have no self contact, with what to do; '': they can have it.
  function self_contact_obstacle(model, elements, law) result(text)
    type(model_type), intent(in) :: model
    integer, intent(in) :: elements(:)
    integer, intent(in) :: law                     !< interaction
    character(:), allocatable :: text
    text = ''
    if (is_compliant(model%interactions(law))) then
      text = 'the interaction ' // model%interactions(law)%name // ' is not hard. Name two surfaces with *CONTACT PAIR.'
    else if (.not. model%general_contact%is_mortar .and. any(has_midsides(model%mesh%kind(elements)))) then
      text = 'contact at nodes would keep edges with mid-side nodes straight. Give *CONTACT, TYPE=SURFACE TO SURFACE.'
    end if
  end function self_contact_obstacle

end module amontons_self_contact_pairs
