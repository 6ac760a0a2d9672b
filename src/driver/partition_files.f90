!> The files of partitions of the results: those of this rank, and their pages in the checkpoint.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! With G partitions the ranks form G groups, and the first rank of each group writes its file; on fewer ranks than partitions a
!! rank writes several. The file that ties them, job.vtkhdf, belongs to the first rank, which writes an increment when all
!! partitions have it: a reader never sees an increment of which a part is missing.
module amontons_partition_files
  use, intrinsic :: iso_fortran_env, only: INT32
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type
  use amontons_model, only: model_type, job_options_type, job_path
  use amontons_iteration_records, only: increment_record_type
  use amontons_state, only: fields_type
  use amontons_hdf5_file, only: hdf5_pages_type, repair_hdf5
  use amontons_result_partitions, only: partition_type, divide_model, partition_ending, writing_rank
  use amontons_results, only: results_type, open_results, write_model, resume_results, write_increment, close_results, &
    export_result_pages, apply_result_pages, discard_results
  use amontons_mpi_ranks, only: this_rank, n_ranks, join_parts, share_error
  implicit none
  private
  public :: partition_files_type, divide_results, create_partitions, resume_partitions, write_partition_models, write_partitions, &
    export_partition_pages, apply_partition_pages, close_partitions, discard_partitions

  !> The partitions, and the files of this rank.
  type :: partition_files_type
    type(partition_type), allocatable :: partitions(:)      !< all; unallocated: the results are not divided
    integer, allocatable :: number(:)                       !< of the partitions of this rank
    type(results_type), allocatable :: files(:)             !< theirs
  end type partition_files_type

contains

  !> Divides the model, alike on all ranks. Errors: those of METIS.
  subroutine divide_results(self, model, n_wanted, error)
    type(partition_files_type), intent(out) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: n_wanted               !< partitions; 0: none
    type(error_type), allocatable, intent(out) :: error
    integer :: p, n
    allocate (self%number(0), self%files(0))
    if (n_wanted == 0) return
    call divide_model(model, n_wanted, self%partitions, error)
    if (allocated(error)) return
    n = size(self%partitions)
    self%number = pack([(p, p=1, n)], [(writing_rank(p, n, n_ranks()) == this_rank(), p=1, n)])
    deallocate (self%files)
    allocate (self%files(size(self%number)))
  end subroutine divide_results


  !> Creates the files of this rank.
  subroutine create_partitions(self, model, options, error)
    type(partition_files_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    do i = 1, size(self%files)
      if (.not. allocated(error)) call open_results(self%files(i), model, options, error, self%partitions, self%number(i))
    end do
  end subroutine create_partitions


  !> Restores the files of this rank to the commit of the checkpoint and opens them.
  subroutine resume_partitions(self, model, options, pages, error)
    type(partition_files_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(hdf5_pages_type), intent(in) :: pages(:)  !< of all partitions
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    do i = 1, size(self%files)
      if (.not. allocated(error)) call repair_hdf5(job_path(options, trim(partition_ending(self%number(i)))), &
        pages(self%number(i)), error)
      if (.not. allocated(error)) call resume_results(self%files(i), model, 0, options, error, self%partitions, self%number(i))
    end do
  end subroutine resume_partitions


  !> Writes the grids.
  subroutine write_partition_models(self, model, error)
    type(partition_files_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    do i = 1, size(self%files)
      if (.not. allocated(error)) call write_model(self%files(i), model, error)
    end do
  end subroutine write_partition_models


  !> Writes the fields of an increment, if they are due.
  subroutine write_partitions(self, model, fields, record, error)
    type(partition_files_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields        !< committed
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    do i = 1, size(self%files)
      if (.not. allocated(error)) call write_increment(self%files(i), model, fields, record, error)
    end do
  end subroutine write_partitions


  !> The pages of all partitions, on all ranks. Collective; an error of one rank is that of all.
  subroutine export_partition_pages(self, is_old, pages, error)
    type(partition_files_type), intent(in) :: self
    logical, intent(in) :: is_old                  !< .true.: as they are on disk
    type(hdf5_pages_type), allocatable, intent(out) :: pages(:)
    type(error_type), allocatable, intent(out) :: error
    type(hdf5_pages_type) :: own
    real(DP), allocatable :: words(:), all_words(:)
    integer :: i, p, at
    if (.not. allocated(self%partitions)) return
    allocate (words(0), pages(size(self%partitions)))
    do i = 1, size(self%files)
      call export_result_pages(self%files(i), is_old, own, error)
      if (allocated(error)) exit
      words = [words, words_of(own)]
    end do
    call share_error(error)
    if (allocated(error)) return
    call join_parts(words, all_words)              ! of ascending partitions on ascending ranks
    at = 0
    do p = 1, size(pages)
      call take_pages(all_words, at, pages(p))
    end do
  end subroutine export_partition_pages


  !> Pages as reals with the values of 32-bit integers, which all ranks exchange exactly: end, shape, then each page.
  pure function words_of(pages) result(words)
    type(hdf5_pages_type), intent(in) :: pages
    real(DP), allocatable :: words(:)
    integer(INT32), allocatable :: numbers(:)
    integer :: k, n, length
    length = size(pages%bytes, 1) / 4
    n = size(pages%index)
    allocate (words(3 + n * (length + 1)))
    words(:3) = [real(pages%end, DP), real(length, DP), real(n, DP)]
    do k = 1, n
      numbers = transfer(pages%bytes(:, k), numbers, length)
      words(4 + (k - 1) * (length + 1)) = real(pages%index(k), DP)
      words(5 + (k - 1) * (length + 1):3 + k * (length + 1)) = real(numbers, DP)
    end do
  end function words_of


  !> The next pages in words.
  pure subroutine take_pages(words, at, pages)
    real(DP), intent(in) :: words(:)
    integer, intent(inout) :: at                   !< words before them; out: with them
    type(hdf5_pages_type), intent(out) :: pages
    integer :: k, n, length
    pages%end = nint(words(at + 1), I64)
    length = nint(words(at + 2))
    n = nint(words(at + 3))
    at = at + 3
    allocate (pages%index(n), pages%bytes(4 * length, n))
    do k = 1, n
      pages%index(k) = nint(words(at + 1), I64)
      pages%bytes(:, k) = transfer(int(words(at + 2:at + length + 1), INT32), pages%bytes(:, k), 4 * length)
      at = at + length + 1
    end do
  end subroutine take_pages


  !> Writes the pages of the files of this rank.
  subroutine apply_partition_pages(self, error)
    type(partition_files_type), intent(in) :: self
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    do i = 1, size(self%files)
      if (.not. allocated(error)) call apply_result_pages(self%files(i), error)
    end do
  end subroutine apply_partition_pages


  !> Closes the files of this rank; the last pages of guarded files remain in memory.
  subroutine close_partitions(self, error)
    type(partition_files_type), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    do i = 1, size(self%files)
      if (.not. allocated(error)) call close_results(self%files(i), error)
    end do
  end subroutine close_partitions


  !> Closes them; pages that were not applied are lost.
  subroutine discard_partitions(self)
    type(partition_files_type), intent(inout) :: self
    integer :: i
    if (.not. allocated(self%files)) return
    do i = 1, size(self%files)
      call discard_results(self%files(i))
    end do
  end subroutine discard_partitions

end module amontons_partition_files
