!> FOUNDATION: springs to the ground on faces of elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_foundations
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, field_text, next_row
  use amontons_deck_reader, only: reader_type, open_card, report_error, read_real, check_n_fields, elements_of_field, is_card
  use amontons_deck_structure, only: is_shell, structural_face, OTHER_LAYER
  use amontons_deck_surfaces, only: face_number
  use amontons_mesh, only: numbered_face
  use amontons_loads, only: foundation_type
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_text, only: name_key, plural, verb
  implicit none
  private
  public :: read_foundations

contains

  !> All FOUNDATION cards.
  subroutine read_foundations(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    type(foundation_type), allocatable :: list(:)
    integer :: c, n
    n = 0
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'FOUNDATION')) cycle
      if (.not. allocated(list)) allocate (list(0))
      call open_card(reader, c, parameters, row)
      if (reader%dialect == DIALECT_CALCULIX) call report_error(reader, reader%cards%cards(c)%line, 'CalculiX has no ' // &
        '*FOUNDATION: give SPRING1 elements at the nodes of the face, or run the deck in the abaqus dialect.')
      do while (next_row(reader%cards, row))
        call read_row(reader, model, row, list, n)
      end do
    end do
    if (allocated(list)) model%foundations = list(:n)
  end subroutine read_foundations


  !> Row: element or element set, F1 to F6 or F, stiffness per area.
  subroutine read_row(reader, model, row, list, n)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(foundation_type), allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: n                  !< of the list
    type(foundation_type), allocatable :: longer(:)
    integer, allocatable :: elements(:)
    character(:), allocatable :: label
    real(DP) :: stiffness
    integer :: i, face, n_without
    logical :: is_ok
    is_ok = .true.
    call check_n_fields(reader, row, 3)
    call elements_of_field(reader, model%mesh, row, 1, elements, is_ok)
    call read_real(reader, row, 3, 'stiffness of the foundation', stiffness, is_ok)
    if (.not. is_ok) return
    if (.not. stiffness > 0) then
      call report_error(reader, row%line, 'The stiffness of a foundation must be positive: a force per length and area.')
      return
    end if
    label = name_key(field_text(reader%cards, row, 2))
    if (n + size(elements) > size(list)) then
      allocate (longer(2 * (n + size(elements))))
      longer(:n) = list(:n)
      call move_alloc(longer, list)
    end if
    n_without = 0
    do i = 1, size(elements)
      face = foundation_face(model, elements(i), label)
      if (face == OTHER_LAYER) cycle
      if (face == 0) then
        n_without = n_without + 1
      else
        n = n + 1
        list(n) = foundation_type(elements(i), face, stiffness)
      end if
    end do
    if (n_without > 0) call report_error(reader, row%line, plural(n_without, 'element') // ' here ' // &
      verb(n_without, 'takes', 'take') // ' no foundation ' // label // ': faces of solids and plane elements take F1, F2, ' // &
      '..., shells and membranes F. For beams and trusses give SPRING1 elements at their nodes, with the stiffness per length ' // &
      'times the length that belongs to the node.')
  end subroutine read_row


  !> The face that a label names: Fn of solids and plane elements, F of shells and membranes; 0: none, or OTHER_LAYER.
  pure integer function foundation_face(model, e, label) result(face)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                     !< element
    character(*), intent(in) :: label            !< squeezed
    face = numbered_face(model%mesh, e, face_number(label, 'F'))
    if (is_shell(model, e)) then
      face = 0
      if (label == 'F') face = structural_face(model, e, 'P')
    else if (allocated(model%structure)) then
      if (model%structure%section(e) > 0) face = 0
    end if
  end function foundation_face

end module amontons_deck_foundations
