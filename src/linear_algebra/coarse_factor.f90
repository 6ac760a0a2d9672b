!> Factor of the matrix of a coarse space, in single precision. `divided_coarse_factor` extends it to several ranks.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_coarse_factor
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, is_same_pattern
  use amontons_factorization, only: cholesky_type, analyse, factorise, round_factor, solve, FACTOR_OK
  implicit none
  private
  public :: coarse_factor_type, factorise_whole, solve_whole, is_analysed_pattern, keep_pattern, fill_empty_rows

  !> The factor of one matrix A.
  type :: coarse_factor_type
    type(sparse_type) :: pattern                   !< of A, as analysed
    type(cholesky_type) :: factor
  contains
    procedure :: factorise => factorise_whole
    procedure :: solve => solve_whole
  end type coarse_factor_type

contains

  !> Factorizes a matrix, unless its factor would have too many entries. Rows without entries get 1 on the diagonal.
  subroutine factorise_whole(self, matrix, is_held, max_entries, is_ready, error)
    class(coarse_factor_type), intent(inout) :: self
    type(sparse_type), intent(inout) :: matrix     !< A: upper triangle
    logical, intent(in) :: is_held(:)              !< (n) its column of Z has entries in rows of this rank
    real(DP), intent(in) :: max_entries            !< of the factor
    logical, intent(out) :: is_ready               !< .false.: A is not positive definite, or the factor too large
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    associate (unused => is_held)                  ! by the factor that ranks divide
    end associate
    is_ready = .false.
    call fill_empty_rows(matrix)
    if (.not. is_analysed_pattern(self, matrix)) then
      call analyse(self%factor, matrix, error=error)
      if (allocated(error)) return
      call keep_pattern(self, matrix)
    end if
    if (self%factor%n_entries > max_entries) return
    call factorise(self%factor, matrix, status, error=error)
    if (allocated(error)) return
    is_ready = status == FACTOR_OK
    if (is_ready) call round_factor(self%factor)
  end subroutine factorise_whole


  !> c becomes inv(A) c.
  subroutine solve_whole(self, c)
    class(coarse_factor_type), intent(in) :: self  !< ready
    real(DP), allocatable, intent(inout) :: c(:)
    real(DP), allocatable :: x(:)
    allocate (x(size(c)))
    call solve(self%factor, c, x)
    call move_alloc(x, c)
  end subroutine solve_whole


  !> 1 on the diagonal of rows without entries.
  pure subroutine fill_empty_rows(matrix)
    type(sparse_type), intent(inout) :: matrix     !< upper triangle
    integer :: i
    do i = 1, matrix%n_rows
      if (.not. abs(matrix%value(matrix%first(i))) > 0.0_DP) matrix%value(matrix%first(i)) = 1
    end do
  end subroutine fill_empty_rows


  !> Whether the factor was analysed for the pattern of a matrix.
  pure logical function is_analysed_pattern(self, matrix)
    class(coarse_factor_type), intent(in) :: self
    type(sparse_type), intent(in) :: matrix
    is_analysed_pattern = is_same_pattern(matrix, self%pattern)
  end function is_analysed_pattern


  !> Keeps the pattern of a matrix as the one analysed.
  subroutine keep_pattern(self, matrix)
    class(coarse_factor_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    self%pattern = sparse_type(matrix%n_rows, matrix%n_columns)
    self%pattern%first = matrix%first
    self%pattern%column = matrix%column
  end subroutine keep_pattern

end module amontons_coarse_factor
