!> Deck ropes: *MPC, DIST to springs that pull once two nodes are farther apart than their rope is long.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The constraint is one of an inequality, which elimination does not know. A rope therefore is a spring that is far stiffer than
!! what it holds: it gives way by its force over 1e4 E L, L its length at the start.
module amontons_deck_ropes
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, row_type, next_row
  use amontons_deck_mesh, only: draft_type
  use amontons_deck_mpc, only: next_mpc, each_once
  use amontons_deck_reader, only: reader_type, open_card, complain, is_card
  use amontons_model, only: model_type
  use amontons_springs, only: spring_type
  use amontons_topology, only: KIND_SPRINGA
  implicit none
  private
  public :: read_ropes

  real(DP), parameter :: STIFFER = 1.0e4_DP        !< than a cube of the stiffest material, as long as the rope [-]

contains

  !> Reads all DIST of MPC cards. Before: nodes, sets, materials and springs are read; the elements are drafts.
  subroutine read_ropes(reader, model, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    character(:), allocatable :: kind
    integer :: c, line
    logical :: is_ok, has_row
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'MPC')) cycle
      call open_card(reader, c, parameters, row)
      has_row = next_row(reader%cards, row)
      do while (has_row)
        call next_mpc(reader, model, row, 'DIST', has_row, kind, nodes, line, is_ok)
        if (is_ok .and. kind == 'DIST') call add_rope(reader, model, c, line, each_once(nodes), draft)
      end do
    end do
  end subroutine read_ropes


  !> A rope between the first two nodes; the first coordinate of the third is its length.
  subroutine add_rope(reader, model, c, line, nodes, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: line
    integer, intent(in) :: nodes(:)
    type(draft_type), intent(inout) :: draft
    type(spring_type) :: rope
    real(DP) :: distance, modulus
    if (size(nodes) /= 3) then
      call complain(reader, line, 'DIST needs a node three times, another one three times, and a node whose first ' // &
        'coordinate is the distance that they may have.')
      return
    end if
    associate (x => model%mesh%coordinates)
      distance = norm2(x(:, nodes(2)) - x(:, nodes(1)))
      rope%clearance = x(1, nodes(3)) - distance
    end associate
    modulus = stiffest(model)
    if (.not. distance > 0.0_DP .or. .not. modulus > 0.0_DP .or. rope%clearance < -1.0e-6_DP * distance) then
      call complain(reader, line, 'DIST: the two nodes must be apart at the start, not farther than the distance given ' // &
        '(first coordinate of the last node), and a material must be elastic.')
      return
    end if
    rope%is_rope = .true.
    rope%length_node = nodes(3)
    rope%stiffness = STIFFER * modulus * distance
    model%springs = [model%springs, rope]
    call append_draft(draft, c, line, nodes(:2), size(model%springs))
  end subroutine add_rope


  !> The largest Young's modulus of all materials, or what comes near it.
  pure real(DP) function stiffest(model) result(modulus)
    type(model_type), intent(in) :: model
    integer :: i
    modulus = 0.0_DP
    do i = 1, size(model%materials)
      modulus = max(modulus, model%materials(i)%youngs_modulus)
      if (allocated(model%materials(i)%elastic%value)) modulus = max(modulus, maxval(model%materials(i)%elastic%value(1, :)))
    end do
  end function stiffest


  !> One more element among the drafts, with the next label.
  subroutine append_draft(draft, c, line, nodes, spring)
    type(draft_type), intent(inout) :: draft
    integer, intent(in) :: c, line, nodes(2)
    integer, intent(in) :: spring                !< index of its law
    integer, allocatable :: directions(:, :)
    integer :: n
    n = draft%n + 1
    allocate (directions(2, n), source=0)
    directions(:, :draft%n) = draft%directions(:, :draft%n)
    call move_alloc(directions, draft%directions)
    draft%label = [draft%label(:draft%n), maxval(draft%label(:draft%n)) + 1]
    draft%kind = [draft%kind(:draft%n), KIND_SPRINGA]
    draft%card = [draft%card(:draft%n), c]
    draft%line = [draft%line(:draft%n), line]
    call draft%nodes%add(nodes(1))
    call draft%nodes%add(nodes(2))
    draft%first = [draft%first(:n), draft%first(n) + 2]
    draft%material = [draft%material(:draft%n), 0]
    draft%section = [draft%section(:draft%n), 1.0_DP]
    draft%spring = [draft%spring(:draft%n), spring]
    draft%n = n
  end subroutine append_draft

end module amontons_deck_ropes
