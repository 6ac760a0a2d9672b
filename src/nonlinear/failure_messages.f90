!> Sentences of a failure: its name, its cause and its remedy, from the failure code.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_failure_messages
  use amontons_kinds, only: DP
  use amontons_text, only: to_text
  use amontons_failure, only: failure_type, family_of, FAILURE_NONE, FAILURE_MATERIAL, FAILURE_SINGULAR, FAILURE_NOT_FINITE, &
    FAILURE_CONSTRAINTS, FAILURE_FREE_PUSHED, FAILURE_FREE_FLYING, FAILURE_FREE_OPEN, FAILURE_FREE_MOTION, FAILURE_LEFT_MASTER, &
    FAILURE_CYCLE, FAILURE_FLIP, FAILURE_UNSETTLED, FAILURE_PASSED_THROUGH, FAILURE_DEEP, FAILURE_LIMIT_POINT, &
    FAILURE_CONTACT_LIMIT, FAILURE_GROWING, FAILURE_USER_ROUTINE, FAILURE_SIGNAL, FAILURE_CROSSING, FAILURE_CREEP, &
    FAMILY_MATERIAL, &
    FAMILY_SOLVER, FAMILY_CONSTRAINTS, FAMILY_FREE_BODY, FAMILY_LEFT_MASTER, FAMILY_CYCLE, FAMILY_FLIP, FAMILY_UNSETTLED, &
    FAMILY_PENETRATION, FAMILY_LIMIT_POINT, FAMILY_SLOW, FAMILY_USER_ROUTINE, FAMILY_SIGNAL, FAMILY_CREEP
  implicit none
  private
  public :: failure_words, failure_name, remedy_words, node_list, is_same_failure

  integer, parameter :: N_NAMED = 8                !< nodes named in a list

contains

  !> Cause of the failure in one or two sentences. They begin with its name, which programs can search. Empty for FAILURE_NONE.
  pure function failure_words(failure) result(words)
    type(failure_type), intent(in) :: failure
    character(:), allocatable :: words
    words = failure_name(failure)
    select case (failure%code)
    case (FAILURE_NONE)
    case (FAILURE_CYCLE, FAILURE_FLIP, FAILURE_SIGNAL)
      words = words // '.'
    case default
      words = words // ': ' // detail_words(failure)
    end select
  end function failure_words


  !> The sentence after the name.
  pure function detail_words(failure) result(words)
    type(failure_type), intent(in) :: failure
    character(:), allocatable :: words
    select case (failure%code)
    case (FAILURE_MATERIAL)
      words = 'element ' // first_of(failure) // ' is inverted, or its material law has no solution.'
    case (FAILURE_SINGULAR)
      words = 'the stiffness matrix is singular: a body is free to move, or the structure has buckled.'
    case (FAILURE_NOT_FINITE)
      words = 'a force is not finite.'
    case (FAILURE_CONSTRAINTS)
      words = failure%detail
    case (FAILURE_FREE_PUSHED)
      words = 'nothing holds a body against its load, wherever it goes; it went farthest at node ' // first_of(failure) // '.' // &
        all_slip(failure, 'friction does not hold it.')
    case (FAILURE_FREE_FLYING)
      words = 'nothing holds a body against its load; it would fly off at node ' // first_of(failure) // '.'
    case (FAILURE_FREE_OPEN)
      words = 'no slave node touches its master any more, and nothing else holds a body.'
    case (FAILURE_FREE_MOTION)
      words = 'where contact is left, the ' // failure%detail // ': nothing else holds it.'
    case (FAILURE_LEFT_MASTER)
      words = node_list(failure%labels) // ' ran off the master surface.'
    case (FAILURE_UNSETTLED)
      words = 'status or facet still changes at ' // node_list(failure%labels) // '.'
    case (FAILURE_PASSED_THROUGH)
      words = 'node ' // first_of(failure) // ' passed through its master within the increment.'
    case (FAILURE_CROSSING)
      words = failure%detail
    case (FAILURE_DEEP)
      words = node_list(failure%labels) // ' penetrated deeply into the master in one iteration.'
    case (FAILURE_LIMIT_POINT)
      words = 'the stiffness is not positive: the structure buckles, snaps through, or softens.'
    case (FAILURE_CONTACT_LIMIT)
      words = 'no equilibrium nearby: contact is lost unstably'
      if (size(failure%labels) > 0) words = words // ', first at ' // node_list(failure%labels)
      words = words // '.' // all_slip(failure, 'if nothing else holds a body, friction does not.')
    case (FAILURE_GROWING)
      words = 'the force imbalance grows from iteration to iteration.'
    case (FAILURE_USER_ROUTINE)
      words = 'PNEWDT is ' // to_text(failure%number) // '.'
    case (FAILURE_CREEP)
      words = 'the creep strains by the conditions at the end and at the start of the increment differ by ' // &
        to_text(0.01_DP * real(nint(100 * failure%number), DP)) // ' CETOL in element ' // first_of(failure) // '.'
    case default
      words = 'the force imbalance does not fall any more.'
    end select
  end function detail_words


  !> Name of a failure; for a cycle with length and nodes.
  pure function failure_name(failure) result(words)
    type(failure_type), intent(in) :: failure
    character(:), allocatable :: words
    select case (family_of(failure))
    case (FAMILY_MATERIAL)
      words = 'MATERIAL'
    case (FAMILY_SOLVER)
      words = 'LINEAR SOLVER'
    case (FAMILY_CONSTRAINTS)
      words = 'CONSTRAINTS'
    case (FAMILY_FREE_BODY)
      words = 'FREE BODY'
    case (FAMILY_LEFT_MASTER)
      words = 'LEFT MASTER'
    case (FAMILY_CYCLE)
      words = 'CYCLE' // of_length(failure)
    case (FAMILY_FLIP)
      words = 'STICK-SLIP FLIP' // of_length(failure)
    case (FAMILY_UNSETTLED)
      words = 'CONTACT UNSETTLED'
    case (FAMILY_PENETRATION)
      words = 'PENETRATION JUMP'
    case (FAMILY_LIMIT_POINT)
      words = 'LIMIT POINT'
    case (FAMILY_SLOW)
      words = 'SLOW'
    case (FAMILY_USER_ROUTINE)
      words = 'A user routine requests a smaller increment'
    case (FAMILY_SIGNAL)
      words = 'The job was stopped by a signal'
    case (FAMILY_CREEP)
      words = 'CREEP'
    case default
      words = ''
    end select
  end function failure_name


  !> One sentence of advice.
  pure function remedy_words(failure) result(words)
    type(failure_type), intent(in) :: failure
    character(:), allocatable :: words
    select case (family_of(failure))
    case (FAMILY_MATERIAL)
      words = 'smaller increments, a better shaped mesh there, or a smaller load.'
    case (FAMILY_SOLVER)
      words = 'look for bodies or nodes that nothing holds, and for numbers in the deck that are out of scale.'
    case (FAMILY_CONSTRAINTS)
      words = 'release a support or an equation of these nodes, or prescribe displacements that all of them allow.'
    case (FAMILY_FREE_BODY)
      words = 'hold the body by supports, or let it touch from the start (ADJUST); friction alone holds only what is pressed.'
    case (FAMILY_LEFT_MASTER)
      words = 'make the master surface larger there, swap slave and master, or check the direction of the motion.'
    case (FAMILY_CYCLE, FAMILY_FLIP, FAMILY_UNSETTLED)
      words = 'smaller increments (first and third number after *STATIC), or a master that is finer or smoother at these nodes.'
    case (FAMILY_PENETRATION)
      words = 'smaller increments, so that a node moves less than half an edge of the master in each.'
    case (FAMILY_LIMIT_POINT)
      words = 'follow the path beyond this load (*STATIC, RIKS), prescribe displacements, or damp the step (*STATIC, STABILIZE).'
    case (FAMILY_CREEP)
      words = 'a smaller least increment (the third number after *VISCO), a larger CETOL, or a load that grows with an AMPLITUDE.'
    case default
      words = 'smaller increments (the first number after *STATIC; the third is the least allowed).'
    end select
  end function remedy_words


  !> Whether two failures have the same name; for cycles also the same length and nodes.
  pure logical function is_same_failure(a, b) result(is_same)
    type(failure_type), intent(in) :: a, b
    integer :: n
    is_same = family_of(a) == family_of(b)
    if (.not. is_same .or. all(family_of(a) /= [FAMILY_CYCLE, FAMILY_FLIP])) return
    is_same = a%length == b%length .and. size(a%labels) == size(b%labels)
    if (.not. is_same) return
    n = min(N_NAMED, size(a%labels))
    is_same = all(a%labels(:n) == b%labels(:n))
  end function is_same_failure


  !> Labels of nodes: the first N_NAMED, and the number of the others.
  pure function node_list(labels) result(names)
    integer, intent(in) :: labels(:)
    character(:), allocatable :: names
    integer :: i
    names = 'node'
    if (size(labels) /= 1) names = 'nodes'
    do i = 1, min(size(labels), N_NAMED)
      if (i > 1) names = names // ','
      names = names // ' ' // to_text(labels(i))
    end do
    if (size(labels) > N_NAMED) names = names // ' and ' // to_text(size(labels) - N_NAMED) // ' more'
  end function node_list


  !> The first label.
  pure function first_of(failure) result(text)
    type(failure_type), intent(in) :: failure
    character(:), allocatable :: text
    text = to_text(failure%labels(1))
  end function first_of


  !> ' of length 2 at nodes 3, 4'.
  pure function of_length(failure) result(words)
    type(failure_type), intent(in) :: failure
    character(:), allocatable :: words
    words = ' of length ' // to_text(failure%length) // ' at ' // node_list(failure%labels)
  end function of_length


  !> A sentence if all closed slave nodes slip; else nothing.
  pure function all_slip(failure, what) result(words)
    type(failure_type), intent(in) :: failure
    character(*), intent(in) :: what               !< the consequence
    character(:), allocatable :: words
    words = ''
    if (failure%n_slipping > 1) words = ' All ' // to_text(failure%n_slipping) // ' closed slave nodes slip: ' // what
  end function all_slip

end module amontons_failure_messages
