!> Audit of pushes: bodies that nothing but contact from one side holds, and that no load presses against it.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A force of contact lies within the cone of friction about its normal n. If for some direction t all normals on a body
!! have n't > mu sqrt(1 - (n't)^2), every force of contact on it has a part along t, and without supports and loads there is
!! no equilibrium but without contact. t is the mean of the normals. Cost: linear in nodes and slaves.
module amontons_audit_pushes
  use amontons_kinds, only: DP
  use amontons_errors, only: complaints_type
  use amontons_topology, only: KIND_SPRINGA
  use amontons_model, only: model_type
  use amontons_state, only: slave_type
  use amontons_rows, only: contact_row_type
  use amontons_contact, only: contact_type, touching_row
  use amontons_audit_words, only: warn
  use amontons_audit_bodies, only: bodies_type, body_name
  implicit none
  private
  public :: check_pushes

contains

  !> Warns of each such body.
  subroutine check_pushes(model, contact, slaves, bodies, report)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slaves(:)      !< as the first increment finds them
    type(bodies_type), intent(in) :: bodies
    type(complaints_type), intent(inout) :: report
    real(DP), allocatable :: way(:, :)             ! (3, n_bodies) mean of the normals that push
    logical, allocatable :: is_pushed(:)           ! (n_bodies) by contact alone, from one side
    integer :: b
    if (size(slaves) == 0) return
    allocate (way(3, bodies%n), source=0.0_DP)
    allocate (is_pushed(bodies%n), source=.true.)
    call leave_out(model, slaves, bodies, is_pushed)
    call look_at_pushes(model, contact, slaves, bodies, .false., way, is_pushed)
    do b = 1, bodies%n
      if (norm2(way(:, b)) > 0.0_DP) way(:, b) = way(:, b) / norm2(way(:, b))
    end do
    call look_at_pushes(model, contact, slaves, bodies, .true., way, is_pushed)
    do b = 1, bodies%n
      if (is_pushed(b) .and. norm2(way(:, b)) > 0.5_DP) call warn(report, 'Nothing but contact holds the ' // &
        body_name(model, bodies%list(b)) // ', no load acts on it, and all contact pushes it one way: it will move off. ' // &
        'Hold it by *BOUNDARY, or load it against what it touches.')
    end do
  end subroutine check_pushes


  !> Bodies with a support, an equation, a spring or a load in some step; and those of pairs that are apart: they may be caught.
  subroutine leave_out(model, slaves, bodies, is_pushed)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slaves(:)
    type(bodies_type), intent(in) :: bodies
    logical, intent(inout) :: is_pushed(:)
    logical, allocatable :: is_apart(:)            ! (n_pairs)
    integer :: i, k, s, p
    where (bodies%list%n_elements == 0) is_pushed = .false.
    do i = 1, size(model%steps)
      associate (step => model%steps(i))
        call drop(bodies%of_node(step%prescribed%node))
        call drop(bodies%of_node(step%concentrated%node))
        call drop(bodies%of_element(step%distributed%element))
      end associate
    end do
    do k = 1, size(model%equations)
      call drop(bodies%of_node(model%equations(k)%node))
    end do
    call drop(pack(bodies%of_element, model%mesh%kind >= KIND_SPRINGA))
    allocate (is_apart(size(model%pairs)), source=.true.)
    do s = 1, size(slaves)
      if (slaves(s)%facet > 0) is_apart(slaves(s)%pair) = .false.
    end do
    do p = 1, size(model%pairs)
      if (.not. is_apart(p)) cycle
      call drop(bodies%of_node(model%surfaces(model%pairs(p)%slave)%nodes))
      call drop(bodies%of_node(model%surfaces(model%pairs(p)%master)%nodes))
    end do

  contains

    !> These bodies are held or loaded.
    subroutine drop(list)
      integer, intent(in) :: list(:)               !< bodies; 0: none
      integer :: j
      do j = 1, size(list)
        if (list(j) > 0) is_pushed(list(j)) = .false.
      end do
    end subroutine drop

  end subroutine leave_out


  !> Adds up the normals on each body, or judges them against their mean.
  subroutine look_at_pushes(model, contact, slaves, bodies, is_judging, way, is_pushed)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slaves(:)
    type(bodies_type), intent(in) :: bodies
    logical, intent(in) :: is_judging
    real(DP), intent(inout) :: way(:, :)           !< (3, n_bodies)
    logical, intent(inout) :: is_pushed(:)
    type(contact_row_type) :: row
    real(DP) :: push(3)
    integer :: s, i, b
    do s = 1, size(slaves)
      if (slaves(s)%facet == 0 .or. .not. contact%overlaps%is_kept(s)) cycle
      call touching_row(contact, slaves(s), row)
      do i = 1, size(row%nodes)
        b = bodies%of_node(row%nodes(i))
        if (b == 0) cycle
        push = row%weights(i) * slaves(s)%normal
        if (.not. is_judging) way(:, b) = way(:, b) + push
        if (is_judging .and. .not. goes_along(model, slaves(s)%pair, push, way(:, b))) is_pushed(b) = .false.
      end do
    end do
  end subroutine look_at_pushes


  !> Whether every force of a contact has a part along a direction, whatever its friction.
  pure logical function goes_along(model, pair, push, way)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    real(DP), intent(in) :: push(3)                !< along the normal, of any length
    real(DP), intent(in) :: way(3)                 !< unit vector
    real(DP) :: along
    goes_along = .true.
    if (.not. norm2(push) > 0.0_DP) return
    along = dot_product(push, way) / norm2(push)
    associate (law => model%interactions(model%pairs(pair)%interaction))
      goes_along = .not. law%is_user_friction .and. along > law%friction * sqrt(max(0.0_DP, 1.0_DP - along**2))
    end associate
  end function goes_along

end module amontons_audit_pushes
