!> Incomplete Cholesky factor with the pattern of the matrix, on several threads by domains and a border.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! U'U = A + shift diag(A) on the pattern of A, with the least shift for which U exists. U is in single precision.
!!
!! On several threads the unknowns are divided into a domain for each. Where A joins two domains, the unknown of the higher one
!! moves to the border, whose rows come last. So domains do not depend on one another, all entries of A stay in the pattern, and
!! the iterations are nearly those of one thread. One thread works on the border, whose share falls with the size of the model.
!! References: Meijerink and van der Vorst, Math. Comp. 31 (1977) 148; Manteuffel, Math. Comp. 34 (1980) 473 (the shift);
!! Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, sec. 12.6 (domains and their border).
module amontons_incomplete_cholesky
  use amontons_kinds, only: DP, SP
  use amontons_containers, only: list_groups
  use amontons_sparse, only: sparse_type
  implicit none
  private
  public :: incomplete_cholesky_type, factorise_incomplete, apply_incomplete, discard_incomplete

  integer, parameter :: MAX_SHIFTS = 10             !< shifts of the diagonal
  real(DP), parameter :: INITIAL_SHIFT = 4.0e-3_DP       !< of the diagonal, if the factorization breaks down [-]
  real(DP), parameter :: MIN_PIVOT_RATIO = 1.0e-3_DP          !< smallest accepted pivot over its diagonal entry [-]

  !> The factor of one matrix.
  type :: incomplete_cholesky_type
    integer :: n = 0                                   !< unknowns
    real(SP), allocatable :: value(:)                  !< U, in the pattern of A or `pattern`; its diagonal as the reciprocal
    real(DP) :: shift = 0                              !< of the diagonal, used by the factor [-]
    integer :: n_domains = 1                           !< a thread works on each
    integer, allocatable :: first_row(:)               !< (n_domains + 2) first row of each domain and of the border, and n + 1, if
                                                       !! there are several domains
    integer, allocatable :: unknown(:)                 !< (n) unknown of each row, likewise: domain after domain, the border last
    type(sparse_type) :: pattern                       !< of U by rows, likewise
    integer, allocatable :: border_entry(:)            !< (n) its first entry of each row in a column of the border, likewise
  end type incomplete_cholesky_type

contains

  !> U with the least shift of the diagonal with which it exists.
  subroutine factorise_incomplete(self, matrix, domain, is_broken, least_shift)
    type(incomplete_cholesky_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix            !< A: symmetric, upper triangle with its diagonal
    integer, intent(in) :: domain(:)                   !< (n) of each unknown, from 1; one domain: may be empty
    logical, intent(out) :: is_broken                  !< .true.: A is far from positive definite
    real(DP), intent(in), optional :: least_shift      !< to begin with in place of 0 [-]
    integer :: attempt
    is_broken = .false.
    self%n = matrix%n_rows
    self%shift = 0
    if (present(least_shift)) self%shift = least_shift
    self%n_domains = max(1, maxval([1, domain]))
    if (self%n_domains > 1) call divide_rows(self, matrix, domain)
    if (allocated(self%value)) then
      if (size(self%value) /= size(matrix%column)) deallocate (self%value)
    end if
    if (.not. allocated(self%value)) allocate (self%value(size(matrix%column)))
    do attempt = 1, MAX_SHIFTS
      if (self%n_domains == 1) then
        call factorise_rows(matrix, 1, 1, self%n, self%shift, self%value, is_broken)
      else
        call factorise_domains(self, is_broken)
      end if
      if (.not. is_broken) exit
      self%shift = max(INITIAL_SHIFT, 2.0_DP * self%shift)
    end do
    if (allocated(self%pattern%value)) deallocate (self%pattern%value)
  end subroutine factorise_incomplete


  !> Frees the memory of the factor.
  subroutine discard_incomplete(self)
    type(incomplete_cholesky_type), intent(inout) :: self
    self = incomplete_cholesky_type()
  end subroutine discard_incomplete


  !> Numbers the rows by domains, then the border, and lists A in their order.
  subroutine divide_rows(self, matrix, domain)
    type(incomplete_cholesky_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: domain(:)                   !< (n) of each unknown
    integer :: group(self%n), row_of(self%n), i, k, p, n_rows_inside
    group = domain
    do i = 1, self%n
      do p = matrix%first(i) + 1, matrix%first(i + 1) - 1
        k = matrix%column(p)
        if (group(i) == group(k) .or. max(group(i), group(k)) > self%n_domains) cycle
        if (group(i) > group(k)) group(i) = self%n_domains + 1
        if (group(k) > group(i)) group(k) = self%n_domains + 1
      end do
    end do
    call list_groups(group, self%n_domains + 1, self%first_row, self%unknown)
    !$omp parallel do schedule(static)
    do i = 1, self%n
      row_of(self%unknown(i)) = i
    end do
    !$omp end parallel do
    n_rows_inside = self%first_row(self%n_domains + 1) - 1
    call count_entries(self, matrix, row_of, n_rows_inside)
    call list_entries(self, matrix, row_of, n_rows_inside)
  end subroutine divide_rows


  !> The first entry of each row: those of A above the diagonal, but those between the border and a domain stand in the row of the
  !! domain.
  subroutine count_entries(self, matrix, row_of, n_rows_inside)
    type(incomplete_cholesky_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: row_of(:)                   !< (n) of each unknown
    integer, intent(in) :: n_rows_inside               !< of the domains
    integer :: row, p
    if (allocated(self%pattern%first)) deallocate (self%pattern%first)
    allocate (self%pattern%first(self%n + 1))
    self%pattern%n_rows = self%n
    self%pattern%n_columns = self%n
    associate (first => self%pattern%first)
      first(1) = 1
      !$omp parallel do schedule(static)
      do row = 1, n_rows_inside
        first(row + 1) = matrix%first(self%unknown(row) + 1) - matrix%first(self%unknown(row))
      end do
      !$omp end parallel do
      first(n_rows_inside + 2:) = 0
      do row = n_rows_inside + 1, self%n
        do p = matrix%first(self%unknown(row)), matrix%first(self%unknown(row) + 1) - 1
          associate (other => min(row, row_of(matrix%column(p))))
            first(other + 1) = first(other + 1) + 1
          end associate
        end do
      end do
      do row = 1, self%n
        first(row + 1) = first(row) + first(row + 1)
      end do
    end associate
  end subroutine count_entries


  !> Columns and values of the rows, ascending, and where the columns of the border begin.
  subroutine list_entries(self, matrix, row_of, n_rows_inside)
    type(incomplete_cholesky_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: row_of(:)                   !< (n) of each unknown
    integer, intent(in) :: n_rows_inside               !< of the domains
    integer :: next(self%n), row, k
    if (allocated(self%pattern%column)) deallocate (self%pattern%column)
    if (allocated(self%border_entry)) deallocate (self%border_entry)
    allocate (self%pattern%column(size(matrix%column)), self%pattern%value(size(matrix%column)), self%border_entry(self%n))
    !$omp parallel do schedule(static)
    do row = 1, n_rows_inside
      next(row) = self%pattern%first(row)
      call append(self%unknown(row))
    end do
    !$omp end parallel do
    do row = n_rows_inside + 1, self%n
      next(row) = self%pattern%first(row)
    end do
    do row = n_rows_inside + 1, self%n
      call append(self%unknown(row))
    end do
    !$omp parallel do schedule(static) private(k)
    do row = 1, self%n
      associate (low => self%pattern%first(row), high => self%pattern%first(row + 1) - 1)
        call sort_entries(self%pattern%column(low:high), self%pattern%value(low:high))
        k = high
        do while (self%pattern%column(k) > n_rows_inside .and. k > low)
          k = k - 1
        end do
        self%border_entry(row) = k + 1
      end associate
    end do
    !$omp end parallel do

  contains

    !> The entries of a row of A.
    subroutine append(i)
      integer, intent(in) :: i                         !< unknown
      integer :: q, low
      do q = matrix%first(i), matrix%first(i + 1) - 1
        low = min(row_of(i), row_of(matrix%column(q)))
        self%pattern%column(next(low)) = max(row_of(i), row_of(matrix%column(q)))
        self%pattern%value(next(low)) = matrix%value(q)
        next(low) = next(low) + 1
      end do
    end subroutine append

  end subroutine list_entries


  !> Sorts the entries of a row, which nearly ascend, by insertion.
  pure subroutine sort_entries(column, value)
    integer, intent(inout) :: column(:)
    real(DP), intent(inout) :: value(:)
    real(DP) :: moved_value
    integer :: i, k, moved
    do i = 2, size(column)
      moved = column(i)
      if (column(i - 1) < moved) cycle
      moved_value = value(i)
      do k = i - 1, 1, -1
        if (column(k) < moved) exit
        column(k + 1) = column(k)
        value(k + 1) = value(k)
      end do
      column(k + 1) = moved
      value(k + 1) = moved_value
    end do
  end subroutine sort_entries


  !> The rows of the domains, a thread for each, then those of the border.
  subroutine factorise_domains(self, is_broken)
    type(incomplete_cholesky_type), intent(inout) :: self
    logical, intent(out) :: is_broken                  !< a pivot is not positive
    logical :: is_domain_broken(self%n_domains)
    integer :: d
    associate (first => self%first_row)
      !$omp parallel do schedule(static, 1) num_threads(self%n_domains)
      do d = 1, self%n_domains
        call factorise_rows(self%pattern, first(d), first(d), first(d + 1) - 1, self%shift, self%value, is_domain_broken(d))
      end do
      !$omp end parallel do
      is_broken = any(is_domain_broken)
      if (.not. is_broken) call factorise_rows(self%pattern, 1, first(self%n_domains + 1), self%n, self%shift, self%value, &
        is_broken)
    end associate
  end subroutine factorise_domains


  !> Some rows of U, each from the rows before it that have an entry in its column. Sums are of double precision, U is not.
  subroutine factorise_rows(matrix, start, low, high, shift, u, is_broken)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: start                       !< first row on which they depend: done before, if it is lower than `low`
    integer, intent(in) :: low, high                   !< rows; other rows before them have no entry in their columns
    real(DP), intent(in) :: shift                      !< of the diagonal [-]
    real(SP), intent(inout) :: u(:)                    !< entries; those of the rows are set, the diagonal as the reciprocal
    logical, intent(out) :: is_broken                  !< a pivot is not positive
    integer :: place(low:matrix%n_rows)                ! position of a column in row k, from 1; 0: not in it
    integer :: head(low:high), next(start:high)        ! rows whose next entry is in a column: the first one, the one after a row
    integer :: entry(start:high)                       ! the next entry of a row
    real(DP), allocatable :: row(:)                    ! row k
    real(DP) :: pivot
    integer :: i, k, p, first, last, after
    is_broken = .false.
    if (high < low) return
    allocate (row(maxval(matrix%first(low + 1:high + 1) - matrix%first(low:high))))
    place = 0
    head = 0
    is_broken = .true.
    do i = start, low - 1
      p = matrix%first(i + 1)
      do while (matrix%column(p - 1) >= low)
        p = p - 1
      end do
      call await(i, p)
    end do
    do k = low, high
      first = matrix%first(k)
      last = matrix%first(k + 1) - 1
      row(:last - first + 1) = matrix%value(first:last)
      row(1) = (1.0_DP + shift) * row(1)
      do p = first, last
        place(matrix%column(p)) = p - first + 1
      end do
      i = head(k)
      do while (i > 0)
        after = next(i)
        call subtract_row(matrix, entry(i), matrix%first(i + 1) - 1, u, low, place, row)
        call await(i, entry(i) + 1)
        i = after
      end do
      place(matrix%column(first:last)) = 0
      if (.not. row(1) > MIN_PIVOT_RATIO * matrix%value(first)) return
      pivot = 1.0_DP / sqrt(row(1))
      u(first) = real(pivot, SP)
      u(first + 1:last) = real(pivot * row(2:last - first + 1), SP)
      call await(k, first + 1)
    end do
    is_broken = .false.

  contains

    !> Lists a row at the column of its next entry, if it has one there.
    subroutine await(i, p)
      integer, intent(in) :: i, p
      if (p >= matrix%first(i + 1)) return
      if (matrix%column(p) > high) return
      entry(i) = p
      next(i) = head(matrix%column(p))
      head(matrix%column(p)) = i
    end subroutine await

  end subroutine factorise_rows


  !> Subtracts from row k u_ik times the rest of row i, within the pattern of row k.
  pure subroutine subtract_row(matrix, first, last, u, low, place, row)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: first, last                 !< entries of row i from u_ik to its end
    real(SP), intent(in) :: u(:)
    integer, intent(in) :: low                         !< least column
    integer, intent(in) :: place(low:)                 !< of the columns in row k
    real(DP), intent(inout) :: row(:)
    integer :: p
    do p = first, last
      if (place(matrix%column(p)) > 0) row(place(matrix%column(p))) = row(place(matrix%column(p))) - real(u(first), DP) * &
        real(u(p), DP)
    end do
  end subroutine subtract_row


  !> z = inv(U) inv(U') r.
  subroutine apply_incomplete(self, matrix, r, z)
    type(incomplete_cholesky_type), intent(in) :: self
    type(sparse_type), intent(in) :: matrix            !< A: its pattern is that of U, if there is one domain
    real(DP), intent(in) :: r(:)                       !< (n)
    real(DP), intent(out) :: z(:)                      !< (n)
    if (self%n_domains == 1) then
      z = r
      call eliminate_rows(matrix, self%value, matrix%first(2:), 1, self%n, z)
      call substitute_rows(matrix, self%value, 1, self%n, z)
    else
      call solve_domains(self, r, z)
    end if
  end subroutine apply_incomplete


  !> The same for several domains: inv(U') of the domains, both of the border, inv(U) of the domains.
  subroutine solve_domains(self, r, z)
    type(incomplete_cholesky_type), intent(in) :: self
    real(DP), intent(in) :: r(:)
    real(DP), intent(out) :: z(:)
    real(DP), allocatable :: w(:)                      ! by rows
    real(DP), allocatable :: share(:, :)               ! of each domain in the border
    integer :: border, d
    border = self%first_row(self%n_domains + 1)
    allocate (w(self%n), share(border:self%n, self%n_domains))
    !$omp parallel do schedule(static, 1) num_threads(self%n_domains)
    do d = 1, self%n_domains
      associate (low => self%first_row(d), high => self%first_row(d + 1) - 1)
        w(low:high) = r(self%unknown(low:high))
        call eliminate_rows(self%pattern, self%value, self%border_entry, low, high, w, share(:, d))
      end associate
    end do
    !$omp end parallel do
    w(border:) = r(self%unknown(border:))
    do d = 1, self%n_domains
      w(border:) = w(border:) - share(:, d)
    end do
    call eliminate_rows(self%pattern, self%value, self%pattern%first(2:), border, self%n, w)
    call substitute_rows(self%pattern, self%value, border, self%n, w)
    z(self%unknown(border:)) = w(border:)
    !$omp parallel do schedule(static, 1) num_threads(self%n_domains)
    do d = 1, self%n_domains
      associate (low => self%first_row(d), high => self%first_row(d + 1) - 1)
        call substitute_rows(self%pattern, self%value, low, high, w)
        z(self%unknown(low:high)) = w(low:high)
      end associate
    end do
    !$omp end parallel do
  end subroutine solve_domains


  !> Forward elimination with some rows of U'.
  pure subroutine eliminate_rows(pattern, value, last, low, high, z, share)
    type(sparse_type), intent(in) :: pattern           !< of U
    real(SP), intent(in) :: value(:)                   !< U
    integer, intent(in) :: last(:)                     !< of each row: the entry after those that serve here
    integer, intent(in) :: low, high                   !< rows; their columns lie within them
    real(DP), intent(inout) :: z(:)
    real(DP), intent(out), optional :: share(:)        !< what the other entries, in the last columns of all, take from z
    integer :: k, p, before
    if (present(share)) then
      share = 0
      before = pattern%n_columns - size(share)
    end if
    do k = low, high
      z(k) = z(k) * real(value(pattern%first(k)), DP)
      do p = pattern%first(k) + 1, last(k) - 1
        z(pattern%column(p)) = z(pattern%column(p)) - real(value(p), DP) * z(k)
      end do
      if (.not. present(share)) cycle
      do p = last(k), pattern%first(k + 1) - 1
        share(pattern%column(p) - before) = share(pattern%column(p) - before) + real(value(p), DP) * z(k)
      end do
    end do
  end subroutine eliminate_rows


  !> Backward substitution with some rows of U; those after them are done.
  pure subroutine substitute_rows(pattern, value, low, high, z)
    type(sparse_type), intent(in) :: pattern           !< of U
    real(SP), intent(in) :: value(:)                   !< U
    integer, intent(in) :: low, high                   !< rows
    real(DP), intent(inout) :: z(:)
    real(DP) :: sum
    integer :: k, p
    do k = high, low, -1
      sum = z(k)
      do p = pattern%first(k) + 1, pattern%first(k + 1) - 1
        sum = sum - real(value(p), DP) * z(pattern%column(p))
      end do
      z(k) = sum * real(value(pattern%first(k)), DP)
    end do
  end subroutine substitute_rows

end module amontons_incomplete_cholesky
