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
  use amontons_kinds, only: DP, SP, I8
  use amontons_containers, only: list_groups, sort_ascending
  use amontons_sparse, only: sparse_type, alike_rows
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
    integer, allocatable :: row_of(:)                  !< (n) row of each unknown, likewise
    type(sparse_type) :: pattern                       !< of U by rows, likewise
    integer, allocatable :: moved_first(:)             !< (rows of the domains + 1) first place of a row in the next two, likewise
    integer, allocatable :: moved(:)                   !< entries of A in rows of the border that stand in a row of a domain here
    integer, allocatable :: moved_column(:)            !< their columns here
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
        call factorise_rows(self, matrix, matrix, 1, 1, self%n, is_broken)
      else
        call factorise_domains(self, matrix, is_broken)
      end if
      if (.not. is_broken) exit
      self%shift = max(INITIAL_SHIFT, 2.0_DP * self%shift)
    end do
  end subroutine factorise_incomplete


  !> Frees the memory of the factor.
  subroutine discard_incomplete(self)
    type(incomplete_cholesky_type), intent(inout) :: self
    self = incomplete_cholesky_type()
  end subroutine discard_incomplete


  !> Numbers the rows by domains, then the border, and lists the pattern of A in their order.
  subroutine divide_rows(self, matrix, domain)
    type(incomplete_cholesky_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: domain(:)                   !< (n) of each unknown
    integer :: group(self%n), i, k, p, n_rows_inside
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
    if (allocated(self%row_of)) deallocate (self%row_of)
    allocate (self%row_of(self%n))
    !$omp parallel do schedule(static)
    do i = 1, self%n
      self%row_of(self%unknown(i)) = i
    end do
    !$omp end parallel do
    n_rows_inside = self%first_row(self%n_domains + 1) - 1
    call count_entries(self, matrix, n_rows_inside)
    call list_moved_entries(self, matrix, n_rows_inside)
    call list_columns(self, matrix, n_rows_inside)
    self%pattern%n_alike = alike_rows(self%pattern)
    do k = 2, self%n_domains + 1           ! no three alike rows are divided
      i = self%first_row(k)
      if (i > self%n .or. i == 1) cycle
      if (self%pattern%n_alike(i - 1) > 1_I8) self%pattern%n_alike(max(1, i - 2):min(i + 1, self%n)) = 1_I8
    end do
  end subroutine divide_rows


  !> The first entry of each row: those of A above the diagonal, but those between the border and a domain stand in the row of the
  !! domain.
  subroutine count_entries(self, matrix, n_rows_inside)
    type(incomplete_cholesky_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
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
          associate (other => min(row, self%row_of(matrix%column(p))))
            first(other + 1) = first(other + 1) + 1
          end associate
        end do
      end do
      do row = 1, self%n
        first(row + 1) = first(row) + first(row + 1)
      end do
    end associate
  end subroutine count_entries


  !> The entries of A between the border and a domain that A has in the row of the border, by rows of the domains.
  subroutine list_moved_entries(self, matrix, n_rows_inside)
    type(incomplete_cholesky_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: n_rows_inside               !< of the domains
    integer, allocatable :: entry(:), from(:), to(:), order(:)
    integer :: row, p, pass, n
    do pass = 1, 2
      n = 0
      do row = n_rows_inside + 1, self%n
        do p = matrix%first(self%unknown(row)), matrix%first(self%unknown(row) + 1) - 1
          if (self%row_of(matrix%column(p)) > n_rows_inside) cycle
          n = n + 1
          if (pass == 1) cycle
          entry(n) = p
          from(n) = row
          to(n) = self%row_of(matrix%column(p))
        end do
      end do
      if (pass == 1) allocate (entry(n), from(n), to(n))
    end do
    call list_groups(to, n_rows_inside, self%moved_first, order)
    self%moved = entry(order)
    self%moved_column = from(order)
  end subroutine list_moved_entries


  !> Columns of the rows, ascending, and where those of the border begin.
  subroutine list_columns(self, matrix, n_rows_inside)
    type(incomplete_cholesky_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: n_rows_inside               !< of the domains
    integer :: row, p, k
    if (allocated(self%pattern%column)) deallocate (self%pattern%column)
    if (allocated(self%border_entry)) deallocate (self%border_entry)
    allocate (self%pattern%column(size(matrix%column)), self%border_entry(self%n))
    !$omp parallel do schedule(static) private(p, k)
    do row = 1, self%n
      k = self%pattern%first(row)
      do p = matrix%first(self%unknown(row)), matrix%first(self%unknown(row) + 1) - 1
        if (self%row_of(matrix%column(p)) < row) cycle   ! moved
        self%pattern%column(k) = self%row_of(matrix%column(p))
        k = k + 1
      end do
      if (row <= n_rows_inside) self%pattern%column(k:self%pattern%first(row + 1) - 1) = &
        self%moved_column(self%moved_first(row):self%moved_first(row + 1) - 1)
      call sort_ascending(self%pattern%column(self%pattern%first(row):self%pattern%first(row + 1) - 1))
      k = self%pattern%first(row + 1) - 1
      do while (self%pattern%column(k) > n_rows_inside .and. k > self%pattern%first(row))
        k = k - 1
      end do
      self%border_entry(row) = k + 1
    end do
    !$omp end parallel do
  end subroutine list_columns


  !> The rows of the domains, a thread for each, then those of the border.
  subroutine factorise_domains(self, matrix, is_broken)
    type(incomplete_cholesky_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    logical, intent(out) :: is_broken                  !< a pivot is not positive
    logical :: is_domain_broken(self%n_domains)
    integer :: d
    associate (first => self%first_row)
      !$omp parallel do schedule(static, 1) num_threads(self%n_domains)
      do d = 1, self%n_domains
        call factorise_rows(self, matrix, self%pattern, first(d), first(d), first(d + 1) - 1, is_domain_broken(d))
      end do
      !$omp end parallel do
      is_broken = any(is_domain_broken)
      if (.not. is_broken) call factorise_rows(self, matrix, self%pattern, 1, first(self%n_domains + 1), self%n, is_broken)
    end associate
  end subroutine factorise_domains


  !> Some rows of U, each from the rows before it that have an entry in its column. Sums are of double precision, U is not.
  subroutine factorise_rows(self, matrix, pattern, start, low, high, is_broken)
    type(incomplete_cholesky_type), intent(inout) :: self   !< the values of the rows are set, the diagonal as the reciprocal
    type(sparse_type), intent(in) :: matrix            !< A
    type(sparse_type), intent(in) :: pattern           !< of U
    integer, intent(in) :: start                       !< first row on which they depend: done before, if it is lower than `low`
    integer, intent(in) :: low, high                   !< rows; other rows before them have no entry in their columns
    logical, intent(out) :: is_broken                  !< a pivot is not positive
    integer :: place(low:pattern%n_rows)               ! position of a column in row k, from 1; 0: not in it
    integer :: head(low:high), next(start:high)        ! rows whose next entry is in a column: the first one, the one after a row
    integer :: entry(start:high)                       ! the next entry of a row
    real(DP), allocatable :: row(:)                    ! row k
    real(DP) :: diagonal, pivot
    integer :: i, k, p, first, last, after
    is_broken = .false.
    if (high < low) return
    allocate (row(maxval(pattern%first(low + 1:high + 1) - pattern%first(low:high))))
    place = 0
    head = 0
    is_broken = .true.
    do i = start, low - 1
      p = pattern%first(i + 1)
      do while (pattern%column(p - 1) >= low)
        p = p - 1
      end do
      call await(i, p)
    end do
    do k = low, high
      first = pattern%first(k)
      last = pattern%first(k + 1) - 1
      do p = first, last
        place(pattern%column(p)) = p - first + 1
      end do
      call take_row(self, matrix, k, low, place, row)
      diagonal = row(1)
      row(1) = (1.0_DP + self%shift) * diagonal
      i = head(k)
      do while (i > 0)
        after = next(i)
        call subtract_row(pattern, entry(i), pattern%first(i + 1) - 1, self%value, low, place, row)
        call await(i, entry(i) + 1)
        i = after
      end do
      place(pattern%column(first:last)) = 0
      if (.not. row(1) > MIN_PIVOT_RATIO * diagonal) return
      pivot = 1.0_DP / sqrt(row(1))
      self%value(first) = real(pivot, SP)
      self%value(first + 1:last) = real(pivot * row(2:last - first + 1), SP)
      call await(k, first + 1)
    end do
    is_broken = .false.

  contains

    !> Lists a row at the column of its next entry, if it has one there.
    subroutine await(i, p)
      integer, intent(in) :: i, p
      if (p >= pattern%first(i + 1)) return
      if (pattern%column(p) > high) return
      entry(i) = p
      next(i) = head(pattern%column(p))
      head(pattern%column(p)) = i
    end subroutine await

  end subroutine factorise_rows


  !> The entries of A in a row of U.
  pure subroutine take_row(self, matrix, k, low, place, row)
    type(incomplete_cholesky_type), intent(in) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: k                           !< row
    integer, intent(in) :: low                         !< least column
    integer, intent(in) :: place(low:)                 !< of the columns in the row
    real(DP), intent(inout) :: row(:)
    integer :: p
    if (self%n_domains == 1) then
      row(:matrix%first(k + 1) - matrix%first(k)) = matrix%value(matrix%first(k):matrix%first(k + 1) - 1)
      return
    end if
    do p = matrix%first(self%unknown(k)), matrix%first(self%unknown(k) + 1) - 1
      if (self%row_of(matrix%column(p)) >= k) row(place(self%row_of(matrix%column(p)))) = matrix%value(p)
    end do
    if (k >= size(self%moved_first)) return
    do p = self%moved_first(k), self%moved_first(k + 1) - 1
      row(place(self%moved_column(p))) = matrix%value(self%moved(p))
    end do
  end subroutine take_row


  !> Subtracts from row k u_ik times the rest of row i, within the pattern of row k.
  pure subroutine subtract_row(pattern, first, last, u, low, place, row)
    type(sparse_type), intent(in) :: pattern           !< of U
    integer, intent(in) :: first, last                 !< entries of row i from u_ik to its end
    real(SP), intent(in) :: u(:)
    integer, intent(in) :: low                         !< least column
    integer, intent(in) :: place(low:)                 !< of the columns in row k
    real(DP), intent(inout) :: row(:)
    integer :: p
    do p = first, last
      if (place(pattern%column(p)) > 0) row(place(pattern%column(p))) = row(place(pattern%column(p))) - real(u(first), DP) * &
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


  !> Forward elimination with some rows of U', three at a time where they have the same columns.
  pure subroutine eliminate_rows(pattern, value, last, low, high, z, share)
    type(sparse_type), intent(in) :: pattern           !< of U
    real(SP), intent(in), contiguous :: value(:)       !< U
    integer, intent(in) :: last(:)                     !< of each row: the entry after those that serve here
    integer, intent(in) :: low, high                   !< rows; their columns lie within them
    real(DP), intent(inout), contiguous :: z(:)
    real(DP), intent(out), optional, contiguous :: share(:)   !< what the other entries, in the last columns of all, take from z
    integer :: k, n, p, q, r, before
    real(DP) :: a, b, c
    before = 0
    if (present(share)) then
      share = 0
      before = pattern%n_columns - size(share)
    end if
    k = low
    do while (k <= high)
      p = pattern%first(k)
      if (is_first_of_three(pattern, k)) then
        q = pattern%first(k + 1)
        r = pattern%first(k + 2)
        a = z(k) * real(value(p), DP)
        b = (z(k + 1) - real(value(p + 1), DP) * a) * real(value(q), DP)
        c = (z(k + 2) - real(value(p + 2), DP) * a - real(value(q + 1), DP) * b) * real(value(r), DP)
        z(k) = a
        z(k + 1) = b
        z(k + 2) = c
        p = p + 2 - r
        q = q + 1 - r
        n = last(k + 2) - 1
        call subtract_three(pattern%column(r + 1:n), value(p + r + 1:p + n), value(q + r + 1:q + n), value(r + 1:n), [a, b, c], &
          0, z)
        if (present(share)) then
          r = n + 1
          n = pattern%first(k + 3) - 1
          call subtract_three(pattern%column(r:n), value(p + r:p + n), value(q + r:q + n), value(r:n), [-a, -b, -c], before, share)
        end if
        k = k + 3
        cycle
      end if
      a = z(k) * real(value(p), DP)
      z(k) = a
      do p = p + 1, last(k) - 1
        z(pattern%column(p)) = z(pattern%column(p)) - real(value(p), DP) * a
      end do
      if (present(share)) then
        do p = last(k), pattern%first(k + 1) - 1
          share(pattern%column(p) - before) = share(pattern%column(p) - before) + real(value(p), DP) * a
        end do
      end if
      k = k + 1
    end do
  end subroutine eliminate_rows


  !> Subtracts from z the multiples of three rows with the same columns.
  pure subroutine subtract_three(column, first, second, third, multiple, before, z)
    integer, intent(in), contiguous :: column(:)
    real(SP), intent(in), dimension(:), contiguous :: first, second, third   !< the rows
    real(DP), intent(in) :: multiple(3)
    integer, intent(in) :: before                      !< columns before the first one of z
    real(DP), intent(inout), contiguous :: z(:)
    integer :: i
    do i = 1, size(column)
      z(column(i) - before) = z(column(i) - before) - (real(first(i), DP) * multiple(1) + real(second(i), DP) * multiple(2) + &
        real(third(i), DP) * multiple(3))
    end do
  end subroutine subtract_three


  !> Backward substitution with some rows of U, likewise; those after them are done. The entries are read from the last to the first
  !! one: the processor fetches them ahead in one direction alone.
  pure subroutine substitute_rows(pattern, value, low, high, z)
    type(sparse_type), intent(in) :: pattern           !< of U
    real(SP), intent(in), contiguous :: value(:)       !< U
    integer, intent(in) :: low, high                   !< rows
    real(DP), intent(inout), contiguous :: z(:)
    real(DP) :: a, b, c, x
    integer :: k, p, q, r, j
    k = high
    do while (k >= low)
      if (is_last_of_three(pattern, k, low)) then
        p = pattern%first(k - 2)
        q = pattern%first(k - 1)
        r = pattern%first(k)
        a = z(k - 2)
        b = z(k - 1)
        c = z(k)
        do j = pattern%first(k + 1) - 1 - r, 1, -1
          x = z(pattern%column(r + j))
          a = a - real(value(p + 2 + j), DP) * x
          b = b - real(value(q + 1 + j), DP) * x
          c = c - real(value(r + j), DP) * x
        end do
        c = c * real(value(r), DP)
        b = (b - real(value(q + 1), DP) * c) * real(value(q), DP)
        z(k - 2) = (a - real(value(p + 1), DP) * b - real(value(p + 2), DP) * c) * real(value(p), DP)
        z(k - 1) = b
        z(k) = c
        k = k - 3
      else
        a = z(k)
        do p = pattern%first(k + 1) - 1, pattern%first(k) + 1, -1
          a = a - real(value(p), DP) * z(pattern%column(p))
        end do
        z(k) = a * real(value(pattern%first(k)), DP)
        k = k - 1
      end if
    end do
  end subroutine substitute_rows


  !> Whether a row is the first of three with the same columns behind their diagonal.
  pure logical function is_first_of_three(pattern, k) result(is_first)
    type(sparse_type), intent(in) :: pattern
    integer, intent(in) :: k                           !< row
    is_first = .false.
    if (allocated(pattern%n_alike)) is_first = pattern%n_alike(k) == 3_I8
  end function is_first_of_three


  !> Whether it is the last one.
  pure logical function is_last_of_three(pattern, k, low) result(is_last)
    type(sparse_type), intent(in) :: pattern
    integer, intent(in) :: k                           !< row
    integer, intent(in) :: low                         !< first of all rows
    is_last = .false.
    if (k - 2 >= low) is_last = is_first_of_three(pattern, k - 2)
  end function is_last_of_three

end module amontons_incomplete_cholesky
