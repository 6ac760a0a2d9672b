!> Direct solvers of SuiteSparse: CHOLMOD for symmetric positive definite matrices, UMFPACK as the fall-back.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Cholesky: supernodal, with the ordering given or by METIS. `analyse` once for a pattern, `factorise` for each new
!! matrix, `solve` for each load. The factor's memory is kept between factorisations and analyses.
!! References: Chen, Davis, Hager, Rajamanickam, ACM Trans. Math. Software 35 (2008) 22 (CHOLMOD);
!! Davis, ACM Trans. Math. Software 30 (2004) 196 (UMFPACK).
module amontons_factorization
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_null_ptr, c_ptr
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER, EXIT_INTERNAL
  use amontons_sparse, only: sparse_type
  implicit none
  private
  public :: cholesky_type, lu_type
  public :: analyse, factorise, round_factor, solve, estimate_memory, lu_factorise, lu_solve, set_blas_threads, choose_blas_kernels
  public :: elimination_order, trailing_block, solve_forward, solve_backward, eliminate_inner, substitute_inner
  public :: FACTOR_OK, FACTOR_NOT_POSITIVE, FACTOR_NEARLY_SINGULAR, FACTOR_NOT_FINITE, TOL_PIVOT

  integer, parameter :: FACTOR_OK = 0               !< the factor can be used
  integer, parameter :: FACTOR_NOT_POSITIVE = 1     !< a pivot was not positive; the factor cannot be used
  integer, parameter :: FACTOR_NEARLY_SINGULAR = 2  !< a pivot is at rounding level; the solutions are unreliable
  integer, parameter :: FACTOR_NOT_FINITE = 3       !< the matrix holds NaN or an infinity
  integer, parameter :: STATUS_NO_MEMORY = 4        !< of the shim
  integer, parameter :: STATUS_TOO_LARGE = 5        !< of the shim

  !> A pivot smaller than this fraction of its diagonal entry is at rounding level.
  real(DP), parameter :: TOL_PIVOT = 64 * epsilon(1.0_DP)

  !> A Cholesky factor P A P' = L L'. Components are for reading. A copy of it is empty: analyse again.
  type :: cholesky_type
    integer :: n_unknowns = 0
    real(DP) :: n_entries = 0                !< of L [-]
    real(DP) :: n_operations = 0             !< multiplications and additions of a factorisation [-]
    real(DP) :: megabytes = 0                !< of factor, permuted matrix and work
    integer :: n_supernodes = 0
    integer :: min_pivot_unknown = 0                   !< unknown with the smallest pivot, or where the factorisation broke
    real(DP) :: pivot_ratio = 0              !< smallest pivot over its diagonal entry [-]
    logical :: is_ready = .false.            !< factorised: it can solve
    type(c_ptr), private :: handle = c_null_ptr
  contains
    procedure, private :: copy_factor
    generic :: assignment(=) => copy_factor
    final :: release_factor
  end type cholesky_type

  !> An LU factor with partial pivoting. A copy of it is empty.
  type :: lu_type
    integer :: n_unknowns = 0
    real(DP) :: megabytes = 0                !< at the peak of the factorisation
    real(DP) :: pivot_ratio = 0              !< smallest over largest pivot of the row-scaled matrix [-]
    logical :: is_ready = .false.
    type(c_ptr), private :: handle = c_null_ptr
  contains
    procedure, private :: copy_lu
    generic :: assignment(=) => copy_lu
    final :: release_lu
  end type lu_type

  !> X = A^-1 B for one or several right-hand sides.
  interface solve
    module procedure solve_one, solve_many
  end interface solve

  interface
    function cholesky_new() bind(C, name='amontons_cholesky_new') result(handle)
      import :: c_ptr
      type(c_ptr) :: handle
    end function cholesky_new

    subroutine cholesky_free(handle) bind(C, name='amontons_cholesky_free')
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine cholesky_free

    function cholesky_analyse(handle, n, first, column, permutation, n_last, statistics) &
      bind(C, name='amontons_cholesky_analyse') result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: n
      integer(c_int), intent(in) :: first(*), column(*)
      integer(c_int), intent(in), optional :: permutation(*)
      integer(c_int), value :: n_last
      real(c_double), intent(out) :: statistics(4)
      integer(c_int) :: status
    end function cholesky_analyse

    function cholesky_factorise(handle, value, shift, unknown, ratio) &
      bind(C, name='amontons_cholesky_factorise') result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: value(*)
      real(c_double), intent(in), optional :: shift(*)
      integer(c_int), intent(out) :: unknown
      real(c_double), intent(out) :: ratio
      integer(c_int) :: status
    end function cholesky_factorise

    subroutine cholesky_round(handle) bind(C, name='amontons_cholesky_round')
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine cholesky_round

    function cholesky_solve(handle, n_columns, b, x) bind(C, name='amontons_cholesky_solve') result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: n_columns
      real(c_double), intent(in) :: b(*)
      real(c_double), intent(out) :: x(*)
      integer(c_int) :: status
    end function cholesky_solve

    subroutine cholesky_order(handle, order) bind(C, name='amontons_cholesky_order')
      import :: c_ptr, c_int
      type(c_ptr), value :: handle
      integer(c_int), intent(out) :: order(*)
    end subroutine cholesky_order

    subroutine cholesky_trailing(handle, m, block) bind(C, name='amontons_cholesky_trailing')
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: m
      real(c_double), intent(out) :: block(*)
    end subroutine cholesky_trailing

    function cholesky_half_solve(handle, is_backward, b, x) bind(C, name='amontons_cholesky_half_solve') result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: is_backward
      real(c_double), intent(in) :: b(*)
      real(c_double), intent(out) :: x(*)
      integer(c_int) :: status
    end function cholesky_half_solve

    function cholesky_solve_inner(handle, is_backward, n_last, x) bind(C, name='amontons_cholesky_solve_inner') result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: is_backward, n_last
      real(c_double), intent(inout) :: x(*)
      integer(c_int) :: status
    end function cholesky_solve_inner

    function lu_new() bind(C, name='amontons_lu_new') result(handle)
      import :: c_ptr
      type(c_ptr) :: handle
    end function lu_new

    subroutine lu_free(handle) bind(C, name='amontons_lu_free')
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine lu_free

    function lu_factorise_c(handle, n, first, column, value, ratio, bytes) &
      bind(C, name='amontons_lu_factorise') result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: n
      integer(c_int), intent(in) :: first(*), column(*)
      real(c_double), intent(in) :: value(*)
      real(c_double), intent(out) :: ratio, bytes
      integer(c_int) :: status
    end function lu_factorise_c

    function lu_solve_c(handle, b, x) bind(C, name='amontons_lu_solve') result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: b(*)
      real(c_double), intent(out) :: x(*)
      integer(c_int) :: status
    end function lu_solve_c

    function set_blas_threads_c(n) bind(C, name='amontons_set_blas_threads') result(is_known)
      import :: c_int
      integer(c_int), value :: n
      integer(c_int) :: is_known
    end function set_blas_threads_c

    function choose_kernels_c() bind(C, name='amontons_choose_blas_kernels') result(name)
      import :: c_ptr
      type(c_ptr) :: name
    end function choose_kernels_c
  end interface

contains

  !> Orders the unknowns and finds the pattern of the factor, for all matrices of this pattern.
  !> After it, estimate_memory and the statistics are known; the values are not used. An earlier analysis is discarded,
  !> but its memory is reused.
  subroutine analyse(factor, matrix, permutation, error, n_last)
    type(cholesky_type), intent(inout) :: factor         !< new, or used before
    type(sparse_type), intent(in) :: matrix            !< symmetric, upper triangle with its diagonal
    integer, intent(in), optional :: permutation(:)    !< (n) unknown that comes k-th, from 1; default: METIS decides
    integer, intent(in), optional :: n_last            !< so many last unknowns can be left out of a solution; default: 0
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: statistics(4)
    integer :: status, n_apart
    n_apart = 0
    if (present(n_last)) n_apart = n_last
    call reset_statistics(factor)
    factor%n_unknowns = matrix%n_rows
    if (matrix%n_rows == 0) return
    if (.not. c_associated(factor%handle)) factor%handle = cholesky_new()
    if (.not. c_associated(factor%handle)) then
      call set_error(error, EXIT_SOLVER, 'No memory for the solver.')
      return
    end if
    if (present(permutation)) then
      status = cholesky_analyse(factor%handle, matrix%n_rows, matrix%first - 1, matrix%column - 1, permutation - 1, &
                                n_apart, statistics)
    else
      status = cholesky_analyse(factor%handle, matrix%n_rows, matrix%first - 1, matrix%column - 1, &
                                n_last=n_apart, statistics=statistics)
    end if
    call set_solver_error(status, estimate_memory(factor), error)
    if (allocated(error)) then
      call clear_factor(factor)
      return
    end if
    factor%n_entries = statistics(1)
    factor%n_operations = statistics(2)
    factor%megabytes = statistics(3) / 1.0e6_DP
    factor%n_supernodes = nint(statistics(4))
  end subroutine analyse


  !> Factorises a matrix of the pattern analysed, reusing the memory of the last factorisation.
  !> | status | meaning |
  !> |---|---|
  !> | FACTOR_OK | positive definite: solve works |
  !> | FACTOR_NEARLY_SINGULAR | solve works, but a pivot (factor%min_pivot_unknown) is at rounding level |
  !> | FACTOR_NOT_POSITIVE | broke at the unknown factor%min_pivot_unknown: indefinite or singular |
  !> | FACTOR_NOT_FINITE | the matrix holds NaN or an infinity |
  !> An error is lack of memory or a defect of the program.
  subroutine factorise(factor, matrix, status, shift, error)
    type(cholesky_type), intent(inout) :: factor
    type(sparse_type), intent(in) :: matrix            !< symmetric, upper triangle, of the pattern analysed
    integer, intent(out) :: status                     !< FACTOR_...
    real(DP), intent(in), optional :: shift(:)         !< (n) added to the diagonal, for a preconditioner
    type(error_type), allocatable, intent(out) :: error
    integer :: unknown
    status = FACTOR_OK
    factor%is_ready = .false.
    if (matrix%n_rows /= factor%n_unknowns) then
      call set_error(error, EXIT_INTERNAL, 'The matrix to factorise is not the one analysed.')
      return
    end if
    if (factor%n_unknowns > 0) then
      status = cholesky_factorise(factor%handle, matrix%value, shift, unknown, factor%pivot_ratio)
      factor%min_pivot_unknown = unknown + 1
      if (status == FACTOR_OK .and. .not. factor%pivot_ratio > TOL_PIVOT) status = FACTOR_NEARLY_SINGULAR
      call set_solver_error(status, estimate_memory(factor), error)
    end if
    factor%is_ready = status == FACTOR_OK .or. status == FACTOR_NEARLY_SINGULAR
  end subroutine factorise


  !> x = A^-1 b.
  subroutine solve_one(factor, b, x)
    type(cholesky_type), intent(in) :: factor            !< ready
    real(DP), intent(in) :: b(:)                       !< (n)
    real(DP), intent(out) :: x(:)                      !< (n)
    integer :: status
    status = 0
    if (factor%n_unknowns > 0) status = cholesky_solve(factor%handle, 1, b, x)
    if (status /= 0) x = 0   ! cannot be: the workspace was taken by the analysis
  end subroutine solve_one


  !> Rounds a factor to single precision: half its memory and half the time of a solution, for a preconditioner. Afterwards
  !! solve_forward, solve_backward and the trailing block are not available.
  subroutine round_factor(factor)
    type(cholesky_type), intent(inout) :: factor         !< ready
    if (factor%n_unknowns > 0) call cholesky_round(factor%handle)
  end subroutine round_factor


  !> X = A^-1 B, all columns at once where memory allows.
  subroutine solve_many(factor, b, x)
    type(cholesky_type), intent(in) :: factor            !< ready
    real(DP), intent(in) :: b(:, :)                    !< (n, columns)
    real(DP), intent(out) :: x(:, :)                   !< (n, columns)
    integer :: status
    status = 0
    if (size(b) > 0) status = cholesky_solve(factor%handle, size(b, 2), b, x)
    if (status /= 0) x = 0   ! cannot be: the workspace for one column was taken by the analysis
  end subroutine solve_many


  !> The unknowns in the order in which the factor eliminates them (L L' = P A P').
  subroutine elimination_order(factor, order)
    type(cholesky_type), intent(in) :: factor            !< analysed
    integer, intent(out) :: order(:)                   !< (n) unknown that comes k-th, from 1
    if (factor%n_unknowns > 0) call cholesky_order(factor%handle, order)
    order = order + 1
  end subroutine elimination_order


  !> The last rows and columns of L as a full matrix, zero above the diagonal.
  subroutine trailing_block(factor, block)
    type(cholesky_type), intent(in) :: factor            !< ready
    real(DP), intent(out) :: block(:, :)               !< (m, m)
    if (size(block) > 0) call cholesky_trailing(factor%handle, size(block, 1), block)
  end subroutine trailing_block


  !> x = L^-1 b, both in the order of elimination.
  subroutine solve_forward(factor, b, x)
    type(cholesky_type), intent(in) :: factor            !< ready
    real(DP), intent(in) :: b(:)                       !< (n)
    real(DP), intent(out) :: x(:)                      !< (n)
    if (cholesky_half_solve(factor%handle, 0, b, x) /= 0) x = 0   ! cannot be: see solve_one
  end subroutine solve_forward


  !> x = L'^-1 b, both in the order of elimination.
  subroutine solve_backward(factor, b, x)
    type(cholesky_type), intent(in) :: factor            !< ready
    real(DP), intent(in) :: b(:)                       !< (n)
    real(DP), intent(out) :: x(:)                      !< (n)
    if (cholesky_half_solve(factor%handle, 1, b, x) /= 0) x = 0   ! cannot be: see solve_one
  end subroutine solve_backward


  !> The first half of a solution without the last unknowns, in the order of elimination, by a factor that was rounded:
  !! x = [inv(L_11) b_1; b_2 - L_21 inv(L_11) b_1].
  subroutine eliminate_inner(factor, n_last, x)
    type(cholesky_type), intent(in) :: factor            !< ready, analysed with n_last
    integer, intent(in) :: n_last
    real(DP), intent(inout) :: x(:)                    !< (n) in: b
    if (factor%n_unknowns == 0) return
    if (cholesky_solve_inner(factor%handle, 0, n_last, x) /= 0) x = 0   ! cannot be: see solve_one
  end subroutine eliminate_inner


  !> The second half: x_1 = inv(L_11') (b_1 - L_21' x_2).
  subroutine substitute_inner(factor, n_last, x)
    type(cholesky_type), intent(in) :: factor            !< ready, analysed with n_last
    integer, intent(in) :: n_last
    real(DP), intent(inout) :: x(:)                    !< (n) in: b_1 and x_2
    if (factor%n_unknowns == 0) return
    if (cholesky_solve_inner(factor%handle, 1, n_last, x) /= 0) x = 0   ! cannot be: see solve_one
  end subroutine substitute_inner


  !> Memory that the factorisation takes, known after the analysis [megabytes].
  pure function estimate_memory(factor) result(megabytes)
    type(cholesky_type), intent(in) :: factor
    real(DP) :: megabytes
    megabytes = factor%megabytes
  end function estimate_memory


  !> Factorises an unsymmetric matrix, given by rows. The ordering is kept while the pattern does not change.
  !> Status FACTOR_OK, FACTOR_NEARLY_SINGULAR (it may still solve where the load is in the range) or FACTOR_NOT_FINITE.
  subroutine lu_factorise(lu, matrix, status, error)
    type(lu_type), intent(inout) :: lu
    type(sparse_type), intent(in) :: matrix            !< (n x n)
    integer, intent(out) :: status                     !< FACTOR_...
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: bytes
    status = FACTOR_OK
    lu%is_ready = .false.
    lu%n_unknowns = matrix%n_rows
    if (.not. c_associated(lu%handle)) lu%handle = lu_new()
    if (matrix%n_rows /= matrix%n_columns) then
      call set_error(error, EXIT_INTERNAL, 'The matrix to factorise is not square.')
      return
    else if (.not. c_associated(lu%handle)) then
      call set_error(error, EXIT_SOLVER, 'No memory for the solver.')
      return
    end if
    if (matrix%n_rows > 0) then
      status = lu_factorise_c(lu%handle, matrix%n_rows, matrix%first - 1, matrix%column - 1, matrix%value, &
                              lu%pivot_ratio, bytes)
      lu%megabytes = bytes / 1.0e6_DP
      if (status == FACTOR_OK .and. .not. lu%pivot_ratio > epsilon(1.0_DP)) status = FACTOR_NEARLY_SINGULAR
      call set_solver_error(status, lu%megabytes, error)
    end if
    lu%is_ready = status == FACTOR_OK
  end subroutine lu_factorise


  !> x = A^-1 b with iterative refinement.
  subroutine lu_solve(lu, b, x)
    type(lu_type), intent(in) :: lu                    !< ready
    real(DP), intent(in) :: b(:)                       !< (n)
    real(DP), intent(out) :: x(:)                      !< (n)
    integer :: status
    status = 0
    if (lu%n_unknowns > 0) status = lu_solve_c(lu%handle, b, x)
    if (status /= 0) x = 0   ! impossible for a factor that is ready
  end subroutine lu_solve


  !> Sets the number of BLAS threads of the whole process. Returns whether the BLAS supports it (OpenBLAS does).
  subroutine set_blas_threads(n, is_known)
    integer, intent(in) :: n
    logical, intent(out), optional :: is_known
    logical :: is_openblas
    is_openblas = set_blas_threads_c(n) /= 0
    if (present(is_known)) is_known = is_openblas
  end subroutine set_blas_threads


  !> Selects kernels that the processor supports where OpenBLAS has selected those for unknown processors. To be called before the
  !! first use of the BLAS.
  subroutine choose_blas_kernels(name)
    character(:), allocatable, intent(out) :: name     !< of the kernels in use; empty for another BLAS
    character(1, c_char), pointer :: letters(:)
    type(c_ptr) :: text
    integer :: i
    !$omp critical (blas_kernels)
    text = choose_kernels_c()
    !$omp end critical (blas_kernels)
    name = ''
    if (.not. c_associated(text)) return
    call c_f_pointer(text, letters, [64])
    do i = 1, size(letters)
      if (iachar(letters(i)) == 0) exit
      name = name // letters(i)
    end do
  end subroutine choose_blas_kernels


  !> The error behind a status of the shim; none for the FACTOR_... ones.
  subroutine set_solver_error(status, megabytes, error)
    integer, intent(in) :: status
    real(DP), intent(in) :: megabytes                  !< required; 0: unknown
    type(error_type), allocatable, intent(out) :: error
    character(20) :: number
    select case (status)
    case (FACTOR_OK, FACTOR_NOT_POSITIVE, FACTOR_NEARLY_SINGULAR, FACTOR_NOT_FINITE)
    case (STATUS_NO_MEMORY)
      write (number, '(i0)') nint(min(megabytes, 1.0e9_DP))
      if (megabytes > 0) then
        call set_error(error, EXIT_SOLVER, 'Not enough memory for the factor: it needs ' // trim(number) // ' megabytes.')
      else
        call set_error(error, EXIT_SOLVER, 'Not enough memory to order and analyse the matrix.')
      end if
    case (STATUS_TOO_LARGE)
      call set_error(error, EXIT_SOLVER, 'The factor would have more than 2 147 483 647 entries: too large ' // &
                     'for the direct solver.')
    case default
      call set_error(error, EXIT_INTERNAL, 'SuiteSparse did not accept the matrix or the permutation.')
    end select
  end subroutine set_solver_error


  !> Frees all memory and resets the factor.
  subroutine clear_factor(factor)
    type(cholesky_type), intent(inout) :: factor
    call release_factor(factor)
    call reset_statistics(factor)
  end subroutine clear_factor


  !> Resets the statistics.
  subroutine reset_statistics(factor)
    type(cholesky_type), intent(inout) :: factor
    factor%n_unknowns = 0
    factor%n_entries = 0
    factor%n_operations = 0
    factor%megabytes = 0
    factor%n_supernodes = 0
    factor%min_pivot_unknown = 0
    factor%pivot_ratio = 0
    factor%is_ready = .false.
  end subroutine reset_statistics


  !> Frees the memory of CHOLMOD.
  subroutine release_factor(factor)
    type(cholesky_type), intent(inout) :: factor
    call cholesky_free(factor%handle)
    factor%handle = c_null_ptr
  end subroutine release_factor


  !> A copy is empty: two owners of one handle would free it twice.
  subroutine copy_factor(self, other)
    class(cholesky_type), intent(inout) :: self
    type(cholesky_type), intent(in) :: other
    if (c_associated(self%handle, other%handle)) return
    call clear_factor(self)
  end subroutine copy_factor


  !> Frees the memory of UMFPACK.
  subroutine release_lu(lu)
    type(lu_type), intent(inout) :: lu
    call lu_free(lu%handle)
    lu%handle = c_null_ptr
  end subroutine release_lu


  !> A copy is empty: two owners of one handle would free it twice.
  subroutine copy_lu(self, other)
    class(lu_type), intent(inout) :: self
    type(lu_type), intent(in) :: other
    if (c_associated(self%handle, other%handle)) return
    call release_lu(self)
    self%n_unknowns = 0
    self%is_ready = .false.
  end subroutine copy_lu

end module amontons_factorization
