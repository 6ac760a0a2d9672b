!> Deck changes: the cards MODEL CHANGE, TYPE=ELEMENT, CHANGE SOLID SECTION, CHANGE MATERIAL, EQUATION, REMOVE to what a step
!! changes of the model.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_changes
  use amontons_cards, only: parameter_type, row_type, next_row, field_text
  use amontons_card_form, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_materials, only: read_plastic
  use amontons_deck_reader, only: reader_type, open_card, complain, note, need_no_data, need_at_most, need_integer, &
    nodes_of_field, elements_of_field, is_card
  use amontons_materials, only: material_type
  use amontons_mesh, only: mesh_type
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_text, only: plural
  use amontons_topology, only: KIND_SPRINGA
  implicit none
  private
  public :: is_element_change, read_element_change, read_section_change, read_removal, read_material_change, &
    read_plastic_change

contains

  !> Whether a card is MODEL CHANGE, TYPE=ELEMENT.
  logical function is_element_change(reader, c)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    is_element_change = is_card(reader, c, 'MODELCHANGE')
    if (.not. is_element_change) return
    call open_card(reader, c, parameters, row)
    is_element_change = parameter_word(parameters, 'TYPE', 'ELEMENT') == 'ELEMENT'
  end function is_element_change


  !> MODEL CHANGE, TYPE=ELEMENT: takes elements out or puts them back, from this step on.
  subroutine read_element_change(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: elements(:)
    integer :: i, n, n_same
    logical :: is_ok, is_removal, is_free
    call open_card(reader, c, parameters, row)
    is_removal = has_parameter(parameters, 'REMOVE')
    if (has_parameter(parameters, 'ADD') .eqv. is_removal) then
      call complain(reader, reader%cards%cards(c)%line, '*MODEL CHANGE needs either ADD or REMOVE.')
      return
    end if
    is_free = parameter_word(parameters, 'ADD', 'STRAINFREE') == 'STRAINFREE'
    if (.not. allocated(step%is_absent)) allocate (step%is_absent(model%mesh%n_elements), source=.false.)
    if (.not. allocated(step%is_born)) allocate (step%is_born(model%mesh%n_elements), source=.false.)
    n = 0
    n_same = 0
    do while (next_row(reader%cards, row))
      do i = 1, row%n
        is_ok = .true.
        call elements_of_field(reader, model%mesh, row, i, elements, is_ok)
        n = n + 1
        if (.not. is_ok) cycle
        n_same = n_same + count(step%is_absent(elements) .eqv. is_removal)
        if (.not. is_removal .and. is_free) step%is_born(elements) = step%is_born(elements) .or. step%is_absent(elements)
        step%is_absent(elements) = is_removal
      end do
    end do
    if (n == 0) call complain(reader, reader%cards%cards(c)%line, '*MODEL CHANGE, TYPE=ELEMENT needs data lines with ' // &
      'elements or element sets.')
    if (n_same > 0) call note(reader, reader%cards%cards(c)%line, plural(n_same, 'element') // trim(merge( &
      ' had been taken out before.          ', ' had not been taken out, or are back.', is_removal)))
    if (all(step%is_absent)) call complain(reader, reader%cards%cards(c)%line, 'No element is left in the model.')
  end subroutine read_element_change


  !> CHANGE SOLID SECTION: the elements of a set get another material from this step on.
  subroutine read_section_change(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: set, material
    call open_card(reader, c, parameters, row)
    set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
    material = present_material(model, reader%materials%find(parameter_text(parameters, 'MATERIAL')))
    associate (line => reader%cards%cards(c)%line)
      if (set == 0) call complain(reader, line, 'There is no element set ''' // parameter_text(parameters, 'ELSET') // '''.')
      if (material == 0) call complain(reader, line, 'There is no material ''' // parameter_text(parameters, 'MATERIAL') // &
        '''.')
    end associate
    if (next_row(reader%cards, row)) call need_no_data(reader, row)
    if (set == 0 .or. material == 0) return
    if (.not. allocated(step%material)) step%material = model%mesh%material
    associate (members => model%mesh%element_sets(set)%members)
      if (any(model%mesh%kind(members) >= KIND_SPRINGA)) then
        call complain(reader, reader%cards%cards(c)%line, 'Springs and masses have no material; name solid elements only.')
      else
        step%material(members) = material
      end if
    end associate
  end subroutine read_section_change


  !> The material that a name stands for now: the last one that CHANGE MATERIAL made of it.
  pure integer function present_material(model, material) result(last)
    type(model_type), intent(in) :: model
    integer, intent(in) :: material              !< of the MATERIAL card; 0: none
    last = material
    if (material == 0) return
    do last = size(model%materials), material + 1, -1
      if (model%materials(last)%name == model%materials(material)%name) return
    end do
    last = material
  end function present_material


  !> CHANGE MATERIAL: the elements of a material get a copy of it, which the cards that follow change.
  subroutine read_material_change(reader, model, c, step, copy)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    integer, intent(out) :: copy                 !< index of the copy; 0: trouble, which was told
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(material_type) :: changed
    integer :: old
    copy = 0
    call open_card(reader, c, parameters, row)
    old = present_material(model, reader%materials%find(parameter_text(parameters, 'NAME')))
    if (old == 0) then
      call complain(reader, reader%cards%cards(c)%line, 'There is no material ''' // parameter_text(parameters, 'NAME') // '''.')
      return
    end if
    changed = model%materials(old)
    model%materials = [model%materials, changed]
    copy = size(model%materials)
    if (.not. allocated(step%material)) step%material = model%mesh%material
    where (step%material == old) step%material = copy
  end subroutine read_material_change


  !> CHANGE PLASTIC: the hardening curve of a changed material. What it has hardened so far stays.
  subroutine read_plastic_change(reader, c, model, copy)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(model_type), intent(inout) :: model
    integer, intent(in) :: copy                  !< index of the changed material; 0: none
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    logical :: is_moving
    if (copy == 0) return                        ! told with CHANGE MATERIAL, or by the place of the card
    call open_card(reader, c, parameters, row)
    is_moving = parameter_word(parameters, 'HARDENING', 'ISOTROPIC') /= 'ISOTROPIC'
    associate (material => model%materials(copy))
      if (merge(allocated(material%kinematic), allocated(material%isotropic), is_moving)) then
        call read_plastic(reader, c, material)
      else
        call complain(reader, reader%cards%cards(c)%line, 'The material ''' // material%name // ''' has no *PLASTIC with ' // &
          'this HARDENING, which could be changed.')
      end if
    end associate
  end subroutine read_plastic_change


  !> EQUATION, REMOVE: the equations whose first term is one of these degrees of freedom hold no more.
  subroutine read_removal(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: step                  !< the present one
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    integer :: i, first, last, n
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    if (.not. has_parameter(parameters, 'REMOVE')) return   ! told elsewhere
    if (parameter_word(parameters, 'REMOVE', '') == 'ALL') then
      where (model%equations%first_dof > 0) model%equations%last_step = min(step - 1, model%equations%last_step)
      return
    end if
    do while (next_row(reader%cards, row))
      is_ok = .true.
      call need_at_most(reader, row, 3)
      call nodes_of_field(reader, model%mesh, row, 1, nodes, is_ok)
      call need_integer(reader, row, 2, 'first degree of freedom', first, is_ok)
      call need_integer(reader, row, 3, 'last degree of freedom', last, is_ok, default=first)
      if (.not. is_ok) cycle
      n = 0
      do i = 1, size(model%equations)
        associate (equation => model%equations(i))
          if (equation%first_dof < first .or. equation%first_dof > last) cycle
          if (.not. any(nodes == equation%node(1))) cycle
          equation%last_step = min(step - 1, equation%last_step)
          n = n + 1
        end associate
      end do
      if (n == 0) call note(reader, row%line, 'No equation has its first term here; none is removed.')
    end do
  end subroutine read_removal

end module amontons_deck_changes
