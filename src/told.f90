!> Told: what the result file tells in words of attempts at increments: why one failed, at which nodes, and what to do.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_told
  use amontons_errors, only: error_type
  use amontons_history, only: increment_record_type, STORY_LENGTH
  use amontons_store, only: store_type, table_type, form_type, create_group, create_table, open_table, append_rows, STORE_TEXT, &
    STORE_I32
  implicit none
  private
  public :: told_type, create_told, open_told, append_told

  character(*), parameter :: REASON = '/AMONTONS/history/reason'
  character(*), parameter :: FOLDER = '/AMONTONS/told'
  integer, parameter :: REASON_LENGTH = 240        !< longest reason why an attempt failed
  type(form_type), parameter :: REASON_FORM = form_type(storage=STORE_TEXT, width=REASON_LENGTH)
  type(form_type), parameter :: LINE_FORM = form_type(storage=STORE_TEXT, width=STORY_LENGTH)
  type(form_type), parameter :: ROW_FORM = form_type(storage=STORE_I32)

  !> Tables of the result file.
  type :: told_type
    private
    type(table_type) :: reason                     !< a row per attempt
    type(table_type) :: line                       !< what is told of attempts, one line after the other
    type(table_type) :: attempt                    !< of each line: the row of the history to which it belongs
  end type told_type

contains

  !> Creates the tables; the group of the history is there.
  subroutine create_told(told, store, error)
    type(told_type), intent(out) :: told
    type(store_type), intent(in) :: store
    type(error_type), allocatable, intent(out) :: error
    call create_table(store, told%reason, REASON, REASON_FORM, '[-]', 'Why the attempt failed; empty if it converged.', error)
    if (.not. allocated(error)) call create_group(store, FOLDER, error)
    if (.not. allocated(error)) call create_table(store, told%line, FOLDER // '/line', LINE_FORM, '[-]', &
      'What was told of attempts: of those that failed the worst nodes with their contact, and a remedy.', error)
    if (.not. allocated(error)) call create_table(store, told%attempt, FOLDER // '/attempt', ROW_FORM, '[-]', &
      'The row of the history that the line is about.', error)
  end subroutine create_told


  !> Opens the tables of a file that goes on.
  subroutine open_told(told, store, error)
    type(told_type), intent(out) :: told
    type(store_type), intent(in) :: store
    type(error_type), allocatable, intent(out) :: error
    call open_table(store, told%reason, REASON, REASON_FORM, error)
    if (.not. allocated(error)) call open_table(store, told%line, FOLDER // '/line', LINE_FORM, error)
    if (.not. allocated(error)) call open_table(store, told%attempt, FOLDER // '/attempt', ROW_FORM, error)
  end subroutine open_told


  !> Adds what is told of an attempt.
  subroutine append_told(told, store, record, error)
    type(told_type), intent(inout) :: told
    type(store_type), intent(in) :: store
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: words
    integer :: row, i
    row = int(told%reason%n_rows)
    words = ''
    if (allocated(record%reason)) words = record%reason
    call append_rows(store, told%reason, words, error)
    if (.not. allocated(record%story)) return
    do i = 1, size(record%story)
      if (.not. allocated(error)) call append_rows(store, told%line, trim(record%story(i)), error)
      if (.not. allocated(error)) call append_rows(store, told%attempt, reshape([row], [1, 1]), error)
      if (allocated(error)) return
    end do
  end subroutine append_told

end module amontons_told
