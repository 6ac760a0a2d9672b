!> EMBEDDED ELEMENT: the elements that move with their hosts, the hosts, and the tolerances.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The equations of their nodes are made by `constraints/embedded_elements`.
module amontons_deck_embedded
  use amontons_kinds, only: DP
  use amontons_cards, only: data_row_type, parameter_type, field_text, next_row
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_tolerance, elements_of_field, is_card
  use amontons_element_kinds, only: element_kind_type, element_kind, FAMILY_SOLID, FAMILY_PLANE_STRAIN, FAMILY_PLANE_STRESS, &
    FAMILY_AXISYMMETRIC
  use amontons_embeddings, only: embedding_type
  use amontons_model, only: model_type, DIALECT_CALCULIX
  implicit none
  private
  public :: read_embedded_elements

contains

  !> All EMBEDDED ELEMENT cards.
  subroutine read_embedded_elements(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    logical :: is_embedded(model%mesh%n_elements)    ! by any card
    integer :: c, i
    is_embedded = .false.
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'EMBEDDEDELEMENT')) cycle
      if (.not. allocated(model%embeddings)) allocate (model%embeddings(0))
      model%embeddings = [model%embeddings, embedding_of(reader, model, c)]
      is_embedded(model%embeddings(size(model%embeddings))%elements) = .true.
    end do
    if (.not. allocated(model%embeddings)) return
    do i = 1, size(model%embeddings)
      call find_hosts(reader, model, is_embedded, model%embeddings(i))
    end do
    if (reader%dialect == DIALECT_CALCULIX) call report_note(reader, 0, 'Embedded elements move with their hosts here; ' // &
      'CalculiX 2.20 passes over *EMBEDDED ELEMENT.')
  end subroutine read_embedded_elements


  !> One card; its hosts are the elements of HOST ELSET, or all.
  type(embedding_type) function embedding_of(reader, model, c) result(embedding)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                         !< index of the card
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer, allocatable :: elements(:)
    logical :: is_own(model%mesh%n_elements), is_ok
    integer :: i, found
    call open_card(reader, c, parameters, row)
    embedding%line = reader%cards%cards(c)%line
    is_own = .false.
    do while (next_row(reader%cards, row))
      do i = 1, row%n
        if (field_text(reader%cards, row, i) == '') cycle
        is_ok = .true.
        call elements_of_field(reader, model%mesh, row, i, elements, is_ok)
        if (is_ok) is_own(elements) = .true.
      end do
    end do
    embedding%elements = pack([(i, i=1, model%mesh%n_elements)], is_own)
    if (size(embedding%elements) == 0) call report_error(reader, embedding%line, '*EMBEDDED ELEMENT needs the elements that ' // &
      'are embedded, or their sets.')
    embedding%hosts = [(i, i=1, model%mesh%n_elements)]
    if (has_parameter(parameters, 'HOST ELSET')) then
      found = reader%element_sets%find(parameter_text(parameters, 'HOST ELSET'))
      if (found > 0) then
        embedding%hosts = model%mesh%element_sets(found)%members
      else
        call report_error(reader, embedding%line, 'There is no element set ''' // parameter_text(parameters, 'HOST ELSET') // &
          ''', which HOST ELSET names.')
      end if
    end if
    if (has_parameter(parameters, 'ABSOLUTE EXTERIOR TOLERANCE') .and. .not. has_parameter(parameters, 'EXTERIOR TOLERANCE')) &
      embedding%exterior_tolerance = huge(1.0_DP)
    call read_tolerance(reader, c, parameters, 'EXTERIOR TOLERANCE', embedding%exterior_tolerance)
    call read_tolerance(reader, c, parameters, 'ABSOLUTE EXTERIOR TOLERANCE', embedding%absolute_tolerance)
    call read_tolerance(reader, c, parameters, 'ROUNDOFF TOLERANCE', embedding%roundoff_tolerance)
  end function embedding_of


  !> Leaves the solids, plane and axisymmetric elements that are not embedded themselves.
  subroutine find_hosts(reader, model, is_embedded, embedding)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_embedded(:)            !< (n_elements)
    type(embedding_type), intent(inout) :: embedding
    type(element_kind_type) :: kind
    logical :: is_host(size(embedding%hosts))
    integer :: i
    do i = 1, size(embedding%hosts)
      associate (e => embedding%hosts(i))
        kind = element_kind(model%mesh%kind(e))
        is_host(i) = .not. is_embedded(e) .and. any(kind%family == [FAMILY_SOLID, FAMILY_PLANE_STRAIN, FAMILY_PLANE_STRESS, &
          FAMILY_AXISYMMETRIC])
        if (allocated(model%structure)) is_host(i) = is_host(i) .and. model%structure%section(e) == 0
      end associate
    end do
    embedding%hosts = pack(embedding%hosts, is_host)
    if (size(embedding%hosts) == 0) call report_error(reader, embedding%line, 'There is no host: embedded elements lie in ' // &
      'solids, plane or axisymmetric elements, which are not embedded themselves.')
    embedding%line = reader%cards%line_number(embedding%line)
  end subroutine find_hosts

end module amontons_deck_embedded
