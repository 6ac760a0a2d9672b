!> Failure: why an increment did not converge: the reason, the worst nodes, and what a person can do.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_failure
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_state, only: state_type, STATUS_OPEN
  use amontons_converge, only: VERDICT_DIVERGES, VERDICT_TOO_SLOW
  use amontons_newton, only: newton_type
  use amontons_system, only: system_type, TROUBLE_ELEMENT, TROUBLE_SOLVER, TROUBLE_NOT_FINITE
  implicit none
  private
  public :: failure_reason, failure_lines

  integer, parameter :: N_WORST = 10               !< nodes listed

contains

  !> One sentence: why the attempt failed.
  function failure_reason(model, system, newton, verdict) result(reason)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(newton_type), intent(in) :: newton
    integer, intent(in) :: verdict                 !< VERDICT_... of the last iteration
    character(:), allocatable :: reason
    character(120) :: text
    select case (newton%trouble)
    case (TROUBLE_ELEMENT)
      write (text, '(a,i0,a)') 'Element ', model%mesh%element_label(max(1, system%trouble_item)), ' turned inside out.'
    case (TROUBLE_SOLVER)
      text = 'The stiffness matrix is singular: a body is free to move, or the structure has buckled.'
    case (TROUBLE_NOT_FINITE)
      text = 'A force is not finite.'
    case default
      text = 'The force imbalance does not fall any more.'
      if (verdict == VERDICT_DIVERGES) text = 'The force imbalance grows from iteration to iteration.'
      if (verdict == VERDICT_TOO_SLOW .and. system%contact%n_changed > 0) &
        write (text, '(a,i0,a)') 'Contact does not settle: ', system%contact%n_changed, ' slave nodes still change their status.'
    end select
    reason = trim(text)
  end function failure_reason


  !> What a person can look at and do: the nodes with the largest imbalance, contact, and a remedy.
  function failure_lines(model, system, state, newton) result(lines)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    character(120), allocatable :: lines(:)
    character(120) :: line
    real(DP), allocatable :: size_of(:)
    integer :: i, n
    allocate (lines(0))
    if (newton%trouble == TROUBLE_ELEMENT) then
      lines = [character(120) :: 'Remedy: smaller increments, a better shaped mesh there, or a smaller load.']
      return
    end if
    write (line, '(a,i0,a,es10.3,a,es10.3,a)') 'After ', newton%progress%iteration, ' iterations the largest imbalance is ', &
      newton%progress%residual(0), ' of the largest force, the correction ', newton%progress%correction, '.'
    lines = [line]
    allocate (size_of(model%mesh%n_nodes))
    size_of = norm2(system%residual, dim=1)
    lines = [lines, [character(120) :: 'Nodes with the largest imbalance:']]
    do i = 1, min(N_WORST, model%mesh%n_nodes)
      n = maxloc(size_of, dim=1)
      if (size_of(n) <= 0.0_DP) exit
      write (line, '(a,i0,a,es10.3,a)') '  node ', model%mesh%node_label(n), ': imbalance ', size_of(n), &
        trim(contact_words(model, state, n))
      lines = [lines, line]
      size_of(n) = -1.0_DP
    end do
    lines = [lines, [character(120) :: &
      'Remedy: smaller increments (the first number after *STATIC, the third is the least allowed), or look at the', &
      'nodes named: is a body held only by contact, does a slave node run over an edge of its master?']]
  end function failure_lines


  !> What contact says of a node.
  function contact_words(model, state, node) result(words)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    integer, intent(in) :: node
    character(80) :: words
    character(5), parameter :: STATUS_NAMES(0:2) = ['open ', 'stick', 'slip ']
    integer :: s
    words = ''
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%node /= node) cycle
        write (words, '(4a,es10.3,a,i0)') ', pair ', model%pairs(slave%pair)%name, ': ', &
          trim(STATUS_NAMES(slave%status)) // ', gap ', slave%gap, ', scenario ', slave%scenario
      end associate
    end do
  end function contact_words

end module amontons_failure
