!> Claims: memory that a job needs for sure is asked for at once, before it begins to take it piece by piece.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! An allocation that fails without a word of what to do ends the process, that of a caller of the library too. The large
!! and foreseeable
!! ones (factor, vectors of GMRES, dense blocks) look at their own status; for the many others their sum is asked for here.
module amontons_claims
  use amontons_kinds, only: DP, I64
  use amontons_dense, only: symmetric_eigen
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER
  use amontons_factor, only: set_blas_threads, choose_blas_kernels
  use amontons_model, only: model_type, job_options_type
  use amontons_posix, only: has_memory
  use amontons_text, only: text_of
  implicit none
  private
  public :: claim_blas, claim_deck, claim_matrices

  integer, parameter :: BLAS_BUFFER = 160          !< what OpenBLAS takes at its first call, and some more [megabytes]

contains

  !> Kernels of the BLAS, and its buffer: OpenBLAS takes it at its first call, and asks for ever if there is no room. It works with
  !! one thread: threads share what is above it, and its own, which wait by asking, would only be in their way.
  subroutine claim_blas(error)
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: kernels
    real(DP) :: values(2), vectors(2, 2)
    integer :: unused
    call choose_blas_kernels(kernels)
    call set_blas_threads(1)
    if (has_memory(BLAS_BUFFER)) then
      call symmetric_eigen(reshape([2.0_DP, 1.0_DP, 1.0_DP, 2.0_DP], [2, 2]), values, vectors, unused)
    else
      call set_error(error, EXIT_SOLVER, 'There is not enough memory to begin: ' // text_of(BLAS_BUFFER) // &
        ' megabytes are wanted.')
    end if
  end subroutine claim_blas


  !> Room for the text of a deck and what is made of it. Asked for at once, so that a lack of memory is told and ends no process.
  subroutine claim_deck(options, error)
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    integer(I64), parameter :: COPIES = 4            ! the text, its lines and fields, the mesh
    integer(I64) :: n_bytes
    n_bytes = 0
    if (allocated(options%deck_text)) then
      n_bytes = len(options%deck_text, I64)
    else if (allocated(options%deck)) then
      inquire (file=options%deck, size=n_bytes)
    end if
    call claim('read the deck', COPIES * max(0_I64, n_bytes), error)
  end subroutine claim_deck


  !> Room for what a model of this size has at least beside its factor, which is asked for later: places and entries of the
  !! stiffness and of one more matrix, stresses and histories of three states.
  subroutine claim_matrices(model, error)
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: n_pairs, n_bytes
    integer :: e, n
    associate (mesh => model%mesh)
      n_pairs = 0
      do e = 1, mesh%n_elements
        n = mesh%first(e + 1) - mesh%first(e)
        n_pairs = n_pairs + int(n * (n + 1) / 2, I64)
      end do
      n_bytes = 40 * n_pairs + 3 * 8 * 14 * int(mesh%n_points, I64) + 3 * 8 * 24 * int(mesh%n_nodes, I64)
    end associate
    call claim('solve a model of this size', n_bytes, error)
  end subroutine claim_matrices


  !> Whether so much memory can be had at once. Errors: EXIT_SOLVER.
  subroutine claim(what, n_bytes, error)
    character(*), intent(in) :: what                 !< to follow 'to'
    integer(I64), intent(in) :: n_bytes
    type(error_type), allocatable, intent(out) :: error
    integer(I64), parameter :: MEGABYTE = 1048576
    integer :: megabytes
    megabytes = int(min(n_bytes / MEGABYTE, int(huge(1), I64))) + 1
    if (.not. has_memory(megabytes)) call set_error(error, EXIT_SOLVER, 'There is not enough memory to ' // what // &
      ': at least ' // text_of(megabytes) // ' megabytes are wanted.')
  end subroutine claim

end module amontons_claims
