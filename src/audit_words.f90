!> Audit words: how the audit names nodes, elements and steps, and how it puts a sentence into its report.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_audit_words
  use amontons_errors, only: complaints_type
  use amontons_text, only: text_of
  implicit none
  private
  public :: complain, warn, label_list, step_list, joined, number_of

  integer, parameter :: LABELS_SHOWN = 10      !< labels of a list; the others are counted

contains

  !> Puts an error into the report.
  subroutine complain(report, text)
    type(complaints_type), intent(inout) :: report
    character(*), intent(in) :: text           !< whole sentences: what is wrong, and the remedy
    call report%add('', 0, '', text)
  end subroutine complain


  !> Puts a warning or a note into the report.
  subroutine warn(report, text)
    type(complaints_type), intent(inout) :: report
    character(*), intent(in) :: text           !< whole sentences
    call report%add('', 0, '', text, is_warning=.true.)
  end subroutine warn


  !> '3, 5 and 8'; of more than ten labels '3, 5, ..., 12 and 7 more'.
  pure function label_list(labels) result(text)
    integer, intent(in) :: labels(:)           !< of nodes or elements
    character(:), allocatable :: text
    integer :: i, n_shown
    n_shown = min(size(labels), LABELS_SHOWN)
    text = ''
    do i = 1, n_shown
      text = joined(text, text_of(labels(i)), i == size(labels))
    end do
    if (n_shown < size(labels)) text = joined(text, text_of(size(labels) - n_shown) // ' more', .true.)
  end function label_list


  !> 'step 2', 'steps 1 and 3', 'steps 2 to 5'.
  pure function step_list(steps) result(text)
    integer, intent(in) :: steps(:)            !< numbers, ascending, at least one
    character(:), allocatable :: text
    integer :: n
    n = size(steps)
    if (n == 1) then
      text = 'step ' // text_of(steps(1))
    else if (n > 2 .and. steps(n) - steps(1) == n - 1) then
      text = 'steps ' // text_of(steps(1)) // ' to ' // text_of(steps(n))
    else
      text = 'steps ' // label_list(steps)
    end if
  end function step_list


  !> The text with one more item of an enumeration.
  pure function joined(text, item, is_last) result(longer)
    character(*), intent(in) :: text           !< the items so far, empty at first
    character(*), intent(in) :: item
    logical, intent(in) :: is_last             !< 'and' stands before it
    character(:), allocatable :: longer
    if (text == '') then
      longer = item
    else if (is_last) then
      longer = text // ' and ' // item
    else
      longer = text // ', ' // item
    end if
  end function joined


  !> 'node 7 is', 'nodes 7 and 9 are': the subject of a sentence with its verb.
  pure function number_of(noun, labels, singular, plural) result(text)
    character(*), intent(in) :: noun           !< 'node', 'element'
    integer, intent(in) :: labels(:)
    character(*), intent(in) :: singular       !< verb after one
    character(*), intent(in) :: plural         !< verb after several
    character(:), allocatable :: text
    if (size(labels) == 1) then
      text = noun // ' ' // label_list(labels) // ' ' // singular
    else
      text = text_of(size(labels)) // ' ' // noun // 's (' // label_list(labels) // ') ' // plural
    end if
  end function number_of

end module amontons_audit_words
