!> Failures: each code has a family, a text that begins with its name, and a remedy; decisions use the code, never the text.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_failure_messages
  use amontons_kinds, only: DP
  use amontons_failure, only: failure_type, family_of, FAILURE_NONE, FAILURE_SINGULAR, FAILURE_CONSTRAINTS, FAILURE_FREE_PUSHED, &
    FAILURE_FREE_FLYING, FAILURE_FREE_OPEN, FAILURE_FREE_MOTION, FAILURE_CYCLE, FAILURE_FLIP, FAILURE_DEEP, FAILURE_LIMIT_POINT, &
    FAILURE_CONTACT_LIMIT, FAILURE_SLOW, FAILURE_USER_ROUTINE, FAILURE_SIGNAL, FAILURE_CROSSING, FAILURE_CREEP, N_FAILURES, &
    FAMILY_FREE_BODY, FAMILY_NONE, &
    FAMILY_LIMIT_POINT
  use amontons_failure_messages, only: failure_words, failure_name, remedy_words, is_same_failure
  use amontons_failure_report, only: summarize_attempts, is_always_unsupported
  use amontons_iteration_records, only: increment_record_type
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_all_codes()
  call check_sentences()
  call check_sameness()
  call check_attempts()
  call check_giving_up()
  call suite%finish()

contains

  !> A failure with all components set.
  function sample(code) result(failure)
    integer, intent(in) :: code
    type(failure_type) :: failure
    failure%code = code
    failure%labels = [12, 7]
    failure%length = 3
    failure%number = 0.5_DP
    failure%detail = 'the FREE BODY of a NAME'
  end function sample


  !> Every code has a family; its text is one sentence or more, differs from all others, and begins with its name.
  subroutine check_all_codes()
    type(failure_type) :: failure, other
    character(:), allocatable :: words, name
    integer :: i, k
    do i = 1, N_FAILURES
      failure = sample(i)
      words = failure_words(failure)
      name = failure_name(failure)
      call suite%that('code has a family', family_of(failure) /= FAMILY_NONE)
      call suite%that('words begin with the name', index(words, name) == 1 .and. len(words) > len(name) .and. len(name) > 0)
      call suite%that('words end a sentence, but for a given text', words(len(words):) == '.' .or. &
        any(i == [FAILURE_CONSTRAINTS, FAILURE_CROSSING]))
      call suite%that('there is a remedy', len(remedy_words(failure)) > 20)
      do k = 1, i - 1
        other = sample(k)
        call suite%that('no two codes have the same words', failure_words(other) /= words)
      end do
    end do
    failure = failure_type()
    call suite%that('no failure has no words', failure_words(failure) == '' .and. family_of(failure) == FAMILY_NONE)
  end subroutine check_all_codes


  !> Whole sentences, word for word: programs search for them.
  subroutine check_sentences()
    type(failure_type) :: failure
    integer :: i
    failure = sample(FAILURE_CYCLE)
    call suite%that('cycle', failure_words(failure) == 'CYCLE of length 3 at nodes 12, 7.')
    failure%labels = [(i, i=1, 10)]
    failure%code = FAILURE_FLIP
    call suite%that('flip of many', failure_words(failure) == &
      'STICK-SLIP FLIP of length 3 at nodes 1, 2, 3, 4, 5, 6, 7, 8 and 2 more.')
    failure%labels = [5]
    failure%code = FAILURE_DEEP
    call suite%that('one node', failure_words(failure) == 'PENETRATION JUMP: node 5 penetrated deeply into the master in one ' // &
      'iteration.')
    failure%code = FAILURE_CONTACT_LIMIT
    failure%n_slipping = 4
    call suite%that('limit of contact', failure_words(failure) == 'LIMIT POINT: no equilibrium nearby: contact is lost ' // &
      'unstably, first at node 5. All 4 closed slave nodes slip: if nothing else holds a body, friction does not.')
    failure%labels = [integer ::]
    failure%n_slipping = 0
    call suite%that('the same without nodes', failure_words(failure) == 'LIMIT POINT: no equilibrium nearby: contact is lost ' // &
      'unstably.')
    failure = sample(FAILURE_USER_ROUTINE)
    call suite%that('user routine', failure_words(failure) == 'A user routine requests a smaller increment: PNEWDT is 0.5.')
    failure = sample(FAILURE_CREEP)
    call suite%that('creep', failure_words(failure) == 'CREEP: the creep strains by the conditions at the end and at the ' // &
      'start of the increment differ by 0.5 CETOL in element 12.')
    failure = sample(FAILURE_SIGNAL)
    call suite%that('signal', failure_words(failure) == 'The job was stopped by a signal.')
    failure = sample(FAILURE_CONSTRAINTS)
    call suite%that('constraints', failure_words(failure) == 'CONSTRAINTS: the FREE BODY of a NAME')
  end subroutine check_sentences


  !> Equal names: the family, and for cycles also length and nodes.
  subroutine check_sameness()
    type(failure_type) :: a, b
    a = sample(FAILURE_FREE_FLYING)
    b = sample(FAILURE_FREE_OPEN)
    call suite%that('two of a family', is_same_failure(a, b))
    b = sample(FAILURE_LIMIT_POINT)
    call suite%that('two families', .not. is_same_failure(a, b))
    a = sample(FAILURE_CYCLE)
    b = a
    call suite%that('the same cycle', is_same_failure(a, b))
    b%labels = [12, 8]
    call suite%that('a cycle of other nodes', .not. is_same_failure(a, b))
    b = a
    b%length = 2
    call suite%that('a cycle of another length', .not. is_same_failure(a, b))
    b = a
    b%labels = [12]
    call suite%that('a cycle of fewer nodes', .not. is_same_failure(a, b))
  end subroutine check_sameness


  !> The line about several attempts names equal failures once.
  subroutine check_attempts()
    type(increment_record_type) :: records(5)
    integer :: i
    do i = 1, 5
      records(i)%attempt = i
    end do
    records(1)%failure = sample(FAILURE_FREE_OPEN)
    records(2)%failure = sample(FAILURE_FREE_MOTION)
    records(3)%failure = sample(FAILURE_CYCLE)
    records(4)%failure = sample(FAILURE_SLOW)
    records(5)%failure = sample(FAILURE_SINGULAR)
    call suite%that('attempts', summarize_attempts(records) == &
      'Its attempts failed by FREE BODY, CYCLE of length 3 at nodes 12, 7, SLOW, LINEAR SOLVER.')
    call suite%that('one attempt needs no list', summarize_attempts(records(:1)) == '')
  end subroutine check_attempts


  !> Four consecutive attempts that fail by a free body are enough, whatever the others failed by.
  subroutine check_giving_up()
    integer, parameter :: CODES(4) = [FAILURE_FREE_PUSHED, FAILURE_FREE_FLYING, FAILURE_FREE_OPEN, FAILURE_FREE_MOTION]
    type(increment_record_type) :: records(4)
    integer :: i, k
    do i = 1, 4
      records(i)%attempt = i
      records(i)%reason = 'these words say nothing'
      k = CODES(i)
      records(i)%failure = sample(k)
      call suite%that('a free body', family_of(records(i)%failure) == FAMILY_FREE_BODY)
    end do
    call suite%that('four times: it is free for good', is_always_unsupported(records, 4))
    call suite%that('three attempts are too few', .not. is_always_unsupported(records(:3), 4))
    records(3)%failure = sample(FAILURE_LIMIT_POINT)
    records(3)%reason = 'FREE BODY: these words say nothing either'
    call suite%that('a limit point is none', family_of(records(3)%failure) == FAMILY_LIMIT_POINT)
    call suite%that('once not: it may be held', .not. is_always_unsupported(records, 4))
    records(3)%failure%code = FAILURE_NONE
    call suite%that('once no failure: it may be held', .not. is_always_unsupported(records, 4))
  end subroutine check_giving_up

end program test_failure_messages
