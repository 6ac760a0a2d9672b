!> Files of partitions: pages of all files in one list, resumed files, an option that does not fit the checkpoint.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_partition_files
  use amontons_errors, only: error_type, EXIT_USAGE
  use amontons_analysis, only: analysis_type, start_analysis, advance_analysis, finish_analysis
  use amontons_hdf5_file, only: hdf5_pages_type
  use amontons_job_files, only: describe_result_files
  use amontons_logger, only: logger_type
  use amontons_model, only: job_options_type
  use amontons_partition_files, only: export_partition_pages
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: JOB = 'test_partition_files'
  character(*), parameter :: DECK = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;9,0,0,2;10,1,0,2;' // &
    '11,1,1,2;12,0,1,2;*ELEMENT, TYPE=C3D8, ELSET=ALL;1,1,2,3,4,5,6,7,8;2,5,6,7,8,9,10,11,12;*MATERIAL, NAME=M;*ELASTIC;' // &
    '1000,0;*SOLID SECTION, ELSET=ALL, MATERIAL=M;*BOUNDARY;1,1,3;2,2,3;3,3;4,3;' // &
    '*STEP;*STATIC, DIRECT;0.25,1;*BOUNDARY;9,3,3,0.01;10,3,3,0.01;11,3,3,0.01;12,3,3,0.01;*END STEP;'
  type(suite_type) :: suite
  type(logger_type) :: logger                          ! never opened: quiet

  call check_job()
  call suite%finish()

contains

  !> Starts two bricks with files.
  subroutine start(analysis, error, n_partitions, is_resumed)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    integer, intent(in) :: n_partitions
    logical, intent(in) :: is_resumed
    type(job_options_type) :: options
    options%deck_text = deck_lines(DECK)
    options%is_guarded = .true.
    options%is_resumed = is_resumed
    options%n_partitions = n_partitions
    options%n_threads = 1
    options%job = JOB
    options%outdir = '.'
    call start_analysis(analysis, options, logger, error)
  end subroutine start


  !> Two files of one rank, whose pages come in their order and change after an increment; the job is left and resumed.
  subroutine check_job()
    type(analysis_type) :: analysis, other, resumed
    type(error_type), allocatable :: error
    type(hdf5_pages_type), allocatable :: pages(:)
    logical :: is_done, is_there
    integer :: i
    character(28) :: name
    call start(analysis, error, 2, .false.)
    call suite%that('started', .not. allocated(error))
    if (allocated(error)) return
    call suite%that('both files belong to one rank', all(analysis%partition_files%number == [1, 2]))
    do i = 1, 2
      write (name, '(a, i1, a)') '.partition-000', i, '.vtkhdf'
      inquire (file=JOB // trim(name), exist=is_there)
      call suite%that('there is ' // name, is_there)
    end do
    call suite%that('described', index(describe_result_files(analysis), '2 files ./' // JOB // '.partition-0001.vtkhdf') > 0)
    call export_partition_pages(analysis%partition_files, .false., pages, error)
    call suite%that('none after a checkpoint', all([(size(pages(i)%index), i=1, size(pages))] == 0) .and. size(pages) == 2)
    call suite%that('ends', all(pages%end > 0))
    call start(other, error, 3, .true.)
    call suite%that('other partitions are refused', allocated(error))
    if (allocated(error)) call suite%that('with words', error%code == EXIT_USAGE .and. index(error%message, '--partitions 2') > 0)
    call advance_analysis(analysis, logger, is_done, error)
    call suite%that('an increment', .not. allocated(error))
    call finish_analysis(analysis, logger, error)
    call suite%that('finished', .not. allocated(error))
    if (is_done) return
    call start(resumed, error, 0, .true.)
    call suite%that('resumed with what the files have', .not. allocated(error) .and. resumed%n_partitions == 2)
    do while (.not. (is_done .or. allocated(error)))
      call advance_analysis(resumed, logger, is_done, error)
    end do
    call suite%that('to the end', .not. allocated(error))
    call finish_analysis(resumed, logger, error)
    call suite%that('and closed', .not. allocated(error))
  end subroutine check_job

end program test_partition_files
