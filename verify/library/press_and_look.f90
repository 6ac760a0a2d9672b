!> A Fortran program that drives a job: it presses in its own steps, throws an increment away, and checks Amontons' law.
!! SPDX-License-Identifier: GPL-3.0-or-later
program press_and_look
  use, intrinsic :: iso_fortran_env, only: real64
  use amontons_library, only: job_type, job_options_type, error_type, open_job, try_job, commit_job, rollback_job, &
    finish_job, is_job_done, get_values
  implicit none
  type(job_type) :: job
  type(job_options_type) :: options
  type(error_type), allocatable :: error
  real(real64), allocatable :: before(:, :), after(:, :), normal(:, :), shear(:, :)
  character(500) :: deck
  call get_command_argument(1, deck)
  options%deck = trim(deck)
  options%has_files = .false.
  call open_job(job, options, error)
  call check()
  do while (.not. is_job_done(job))
    call get_values(job, 'U', '', before, error)
    call check()
    call try_job(job, 0.25_real64, error)             ! a look ahead ...
    call check()
    call rollback_job(job, error)                     ! ... that is thrown away
    call check()
    call get_values(job, 'U', '', after, error)
    if (any(before /= after)) error stop 'the rollback is not exact'
    call try_job(job, 0.1_real64, error)
    call check()
    call commit_job(job, error)
    call check()
  end do
  call get_values(job, 'CNORMF', 'CUBE_SOLE', normal, error)
  call get_values(job, 'CSHEARF', 'CUBE_SOLE', shear, error)
  call check()
  write (*, '(a,f9.6)') 'friction over normal force: ', norm2(sum(shear, 2)) / norm2(sum(normal, 2))
  if (abs(norm2(sum(shear, 2)) - 0.3_real64 * norm2(sum(normal, 2))) > 1.0e-6_real64 * norm2(sum(normal, 2))) &
    error stop 'the cube does not slide'
  call finish_job(job, error)
  call check()

contains

  !> Ends the program if there is an error.
  subroutine check()
    if (.not. allocated(error)) return
    write (*, '(a)') error%message
    error stop 1
  end subroutine check

end program press_and_look
