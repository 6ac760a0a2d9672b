!> Ranks: the processes of one job, their elements, and sums, minima and errors over them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! All ranks run the same program on the same model and call the procedures of this module in the same order. What one rank computes
!! alone (the elements of its part, what it reads of clocks and memory) passes through them before a decision depends on it, so
!! that all ranks decide alike. One process without MPI is rank 0 of 1: then each procedure leaves its argument as it is.
module amontons_mpi_ranks
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_int64_t, c_char
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_USAGE
  implicit none
  private
  public :: begin_ranks, end_ranks, join_ranks, leave_ranks, this_rank, n_ranks, is_first_rank, is_last_rank
  public :: sum_over_ranks, gather_parts, join_parts, exchange_with_ranks, min_over_ranks, broadcast_words, share_error, &
    check_agreement, is_shared_by_ranks, abort_ranks

  real(DP), parameter :: SECONDS_TO_MEET = 15.0_DP   !< in which an error that all ranks share reaches all [s]
  ! Of amontons_ranks_join.
  integer(c_int), parameter :: JOIN_DONE = 0, JOIN_WITHOUT_MPI = 1, JOIN_NOT_RUNNING = 2, JOIN_NO_MEMBER = 3

  !> The sum of an array over the ranks, rank by rank: the same bits on all ranks and in every run with as many.
  interface sum_over_ranks
    module procedure sum_vector, sum_table, sum_blocks
  end interface sum_over_ranks

  interface
    !> Begins the communication of the ranks, at the start of the program.
    subroutine begin_ranks() bind(C, name='amontons_ranks_begin')
    end subroutine begin_ranks

    !> Ends it.
    subroutine end_ranks() bind(C, name='amontons_ranks_end')
    end subroutine end_ranks

    function join_c(has_communicator, handle) bind(C, name='amontons_ranks_join') result(status)
      import :: c_int
      integer(c_int), value :: has_communicator, handle
      integer(c_int) :: status
    end function join_c

    !> A job that joined is closed.
    subroutine leave_ranks() bind(C, name='amontons_ranks_leave')
    end subroutine leave_ranks

    function rank_c() bind(C, name='amontons_rank') result(rank)
      import :: c_int
      integer(c_int) :: rank
    end function rank_c

    function n_ranks_c() bind(C, name='amontons_n_ranks') result(n)
      import :: c_int
      integer(c_int) :: n
    end function n_ranks_c

    subroutine sum_c(x, n) bind(C, name='amontons_ranks_sum')
      import :: c_double, c_int64_t
      real(c_double), intent(inout) :: x(*)
      integer(c_int64_t), value :: n
    end subroutine sum_c

    subroutine gather_c(x, counts) bind(C, name='amontons_ranks_gather')
      import :: c_int, c_double
      real(c_double), intent(inout) :: x(*)
      integer(c_int), intent(in) :: counts(*)
    end subroutine gather_c

    subroutine exchange_c(n, other, send_first, sent, receive_first, received) bind(C, name='amontons_ranks_exchange')
      import :: c_int, c_double
      integer(c_int), value :: n
      integer(c_int), intent(in) :: other(*), send_first(*), receive_first(*)
      real(c_double), intent(in) :: sent(*)
      real(c_double), intent(inout) :: received(*)
    end subroutine exchange_c

    function min_c(x) bind(C, name='amontons_ranks_min') result(least)
      import :: c_double
      real(c_double), value :: x
      real(c_double) :: least
    end function min_c

    subroutine broadcast_c(bytes, n, root) bind(C, name='amontons_ranks_broadcast')
      import :: c_char, c_int
      character(1, c_char), intent(inout) :: bytes(*)
      integer(c_int), value :: n, root
    end subroutine broadcast_c

    function meet_c(seconds) bind(C, name='amontons_ranks_meet') result(is_met)
      import :: c_double, c_int
      real(c_double), value :: seconds
      integer(c_int) :: is_met
    end function meet_c

    subroutine abort_c(code) bind(C, name='amontons_ranks_abort')
      import :: c_int
      integer(c_int), value :: code
    end subroutine abort_c
  end interface

contains

  !> A job of a calling program joins the ranks of a communicator, or stays alone without one; leave_ranks ends that.
  !! Errors: EXIT_USAGE, on the ranks that have it.
  subroutine join_ranks(error, communicator)
    type(error_type), allocatable, intent(out) :: error
    integer, intent(in), optional :: communicator  !< a Fortran handle (comm%MPI_VAL of mpi_f08, MPI_Comm_c2f in C)
    integer(c_int) :: status
    if (present(communicator)) then
      status = join_c(1_c_int, int(communicator, c_int))
    else
      status = join_c(0_c_int, 0_c_int)
    end if
    select case (status)
    case (JOIN_DONE)
    case (JOIN_WITHOUT_MPI)
      call set_error(error, EXIT_USAGE, 'This library has one rank; libamontons-mpi (make MPI=1) takes a communicator.')
    case (JOIN_NOT_RUNNING)
      call set_error(error, EXIT_USAGE, 'MPI does not run: call MPI_Init before a job is opened on a communicator.')
    case (JOIN_NO_MEMBER)
      call set_error(error, EXIT_USAGE, 'This process is not in the communicator (MPI_COMM_NULL), or it is an ' // &
        'intercommunicator: only the ranks of an intracommunicator open a job.')
    case default
      call set_error(error, EXIT_USAGE, 'A process has one communicator at a time: close its jobs on other ranks, ' // &
        'and those without a communicator, first.')
    end select
  end subroutine join_ranks


  !> Number of this process, from 0.
  integer function this_rank()
    this_rank = int(rank_c())
  end function this_rank


  !> Number of processes of the job.
  integer function n_ranks()
    n_ranks = int(n_ranks_c())
  end function n_ranks


  !> Whether this process is the one that writes the log, and all files but .frd.
  logical function is_first_rank()
    is_first_rank = rank_c() == 0
  end function is_first_rank


  !> Whether this process is the one that writes .frd.
  logical function is_last_rank()
    is_last_rank = rank_c() == n_ranks_c() - 1
  end function is_last_rank


  !> A vector.
  subroutine sum_vector(x)
    real(DP), intent(inout) :: x(:)
    if (n_ranks_c() > 1) call sum_c(x, size(x, kind=c_int64_t))
  end subroutine sum_vector


  !> A table.
  subroutine sum_table(x)
    real(DP), intent(inout) :: x(:, :)
    if (n_ranks_c() > 1) call sum_c(x, size(x, kind=c_int64_t))
  end subroutine sum_table


  !> Blocks.
  subroutine sum_blocks(x)
    real(DP), intent(inout) :: x(:, :, :)
    if (n_ranks_c() > 1) call sum_c(x, size(x, kind=c_int64_t))
  end subroutine sum_blocks


  !> Completes a vector of which rank r has the r-th part.
  subroutine gather_parts(x, counts)
    real(DP), intent(inout) :: x(:)                !< in: this rank's part at its place; out: all parts
    integer, intent(in) :: counts(:)               !< (n_ranks) lengths of the parts, in the order of the ranks
    call gather_c(x, int(counts, c_int))
  end subroutine gather_parts


  !> The parts of all ranks, one after the other.
  subroutine join_parts(part, whole)
    real(DP), intent(in) :: part(:)                !< of this rank
    real(DP), allocatable, intent(out) :: whole(:)
    real(DP), allocatable :: lengths(:)
    integer :: before
    allocate (lengths(n_ranks()), source=0.0_DP)
    lengths(this_rank() + 1) = real(size(part), DP)
    call sum_over_ranks(lengths)
    allocate (whole(sum(nint(lengths))))
    before = sum(nint(lengths(:this_rank())))
    whole(before + 1:before + size(part)) = part
    call gather_parts(whole, nint(lengths))
  end subroutine join_parts


  !> Numbers to and from some ranks, by a message to each. What another rank sends it lists for this one in the same way.
  subroutine exchange_with_ranks(other, send_first, sent, receive_first, received)
    integer, intent(in) :: other(:)                !< (m) ranks, from 0
    integer, intent(in) :: send_first(:)           !< (m + 1) first number for each in `sent`, from 1
    real(DP), intent(in) :: sent(:)
    integer, intent(in) :: receive_first(:)        !< (m + 1) the same of `received`
    real(DP), intent(inout) :: received(:)
    call exchange_c(size(other, kind=c_int), int(other, c_int), int(send_first - 1, c_int), sent, &
      int(receive_first - 1, c_int), received)
  end subroutine exchange_with_ranks


  !> The least of the ranks' numbers.
  real(DP) function min_over_ranks(x) result(least)
    real(DP), intent(in) :: x
    least = real(min_c(real(x, c_double)), DP)
  end function min_over_ranks


  !> What the ranks did each for itself has one outcome: the error of the first rank that has one, or none.
  subroutine share_error(error)
    type(error_type), allocatable, intent(inout) :: error   !< in: of this rank; out: the same on all
    character(:), allocatable :: message
    character(24) :: head                          ! length of the message, and code
    integer :: root, length, code
    if (n_ranks_c() == 1) return
    root = n_ranks()
    if (allocated(error)) root = this_rank()
    root = nint(min_over_ranks(real(root, DP)))
    if (root == n_ranks()) return
    if (root == this_rank()) write (head, '(2i12)') len(error%message), error%code
    call broadcast_text(head, root)
    read (head, '(2i12)') length, code
    allocate (character(length) :: message)
    if (root == this_rank()) message(:) = error%message
    call broadcast_text(message, root)
    if (root /= this_rank()) call set_error(error, code, message)
  end subroutine share_error


  !> A text of one rank on all ranks.
  subroutine broadcast_text(text, root)
    character(*), intent(inout) :: text            !< of the same length on all ranks
    integer, intent(in) :: root                    !< the rank
    call broadcast_c(text, int(len(text), c_int), int(root, c_int))
  end subroutine broadcast_text


  !> Words of one rank on all ranks.
  subroutine broadcast_words(words, root)
    integer(I64), allocatable, intent(inout) :: words(:)   !< in: of the rank; out: the same on all
    integer, intent(in) :: root                    !< the rank
    character(:), allocatable :: text
    real(DP) :: length(1)
    if (n_ranks_c() == 1) return
    length = 0
    if (root == this_rank()) length = real(size(words), DP)
    call sum_over_ranks(length)
    if (root /= this_rank()) then
      if (allocated(words)) deallocate (words)
      allocate (words(nint(length(1))))
    end if
    allocate (character(8 * size(words)) :: text)
    if (root == this_rank()) text = transfer(words, text)
    call broadcast_text(text, root)
    if (root /= this_rank()) words = transfer(text, words)
  end subroutine broadcast_words


  !> Checks that all ranks give the same numbers. Errors: EXIT_USAGE on all.
  subroutine check_agreement(x, what, error)
    real(DP), intent(in) :: x(:)
    character(*), intent(in) :: what               !< of the numbers, to follow 'different'
    type(error_type), allocatable, intent(inout) :: error
    integer :: i
    logical :: is_equal
    if (n_ranks_c() == 1) return
    is_equal = abs(min_over_ranks(real(size(x), DP)) + min_over_ranks(-real(size(x), DP))) < 0.5_DP
    do i = 1, merge(size(x), 0, is_equal)
      if (abs(min_over_ranks(x(i)) + min_over_ranks(-x(i))) > 0.0_DP) is_equal = .false.
    end do
    if (.not. is_equal) call set_error(error, EXIT_USAGE, 'The ranks give different ' // what // '.')
  end subroutine check_agreement


  !> Whether all ranks come here soon: .false. on a rank whose error the others do not share, as they wait for it elsewhere.
  logical function is_shared_by_ranks()
    is_shared_by_ranks = meet_c(real(SECONDS_TO_MEET + real(this_rank(), DP), c_double)) /= 0
  end function is_shared_by_ranks


  !> Ends the processes of all ranks.
  subroutine abort_ranks(code)
    integer, intent(in) :: code                    !< EXIT_...
    call abort_c(int(code, c_int))
  end subroutine abort_ranks

end module amontons_mpi_ranks
