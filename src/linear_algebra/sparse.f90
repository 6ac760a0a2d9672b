!> Compressed sparse row matrices: assembly from triplets, sums and products.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A matrix is stored by compressed rows with ascending columns. A symmetric matrix stores its upper triangle by rows
!! (column >= row), diagonal always present; the same arrays are its lower triangle by columns, as CHOLMOD requires.
!! Every sum has a fixed order: results repeat bitwise (for a given number of threads where threads are used).
!! Working arrays and linear-time algorithms after Davis, Direct Methods for Sparse Linear Systems, SIAM 2006, ch. 2.
module amontons_sparse
  use amontons_kinds, only: DP, I8, I64
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER, EXIT_INTERNAL
!$ use omp_lib, only: omp_get_max_threads
  implicit none
  private
  public :: sparse_type, triplets_type, entry_position, set_too_large
  public :: sparse_from_triplets
  public :: sparse_transpose, full_from_upper, upper_triangle, rows_of, sparse_product, sparse_sum
  public :: multiply, multiply_transpose, multiply_symmetric
  public :: alike_rows, is_same_pattern

  integer, parameter :: MIN_THREADED_ENTRIES = 200000   !< entries below which threads cost more than they save

  !> A sparse matrix by compressed rows. Row i holds the entries first(i) to first(i + 1) - 1.
  type :: sparse_type
    integer :: n_rows = 0
    integer :: n_columns = 0
    integer, allocatable :: first(:)           !< (n_rows + 1)
    integer, allocatable :: column(:)          !< (nnz) ascending within a row
    real(DP), allocatable :: value(:)          !< (nnz)
    integer(I8), allocatable :: n_alike(:)     !< (n_rows) of an upper triangle, of alike_rows: 3 of a row whose columns
                                               !! behind the diagonal are those of the next two rows, too; 2 and 1 of these; else 1
  end type sparse_type

  !> Entries of a sparse matrix in any order; those of one place are added.
  type :: triplets_type
    integer :: n = 0
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
  end type triplets_type

contains

  !> Makes a matrix from triplets; duplicates are summed in the order given. Cost: linear, no comparison sort.
  subroutine sparse_from_triplets(n_rows, n_columns, row, column, value, matrix, error)
    integer, intent(in) :: n_rows, n_columns
    integer, intent(in) :: row(:)              !< (n) 1 to n_rows
    integer, intent(in) :: column(:)           !< (n) 1 to n_columns
    real(DP), intent(in) :: value(:)           !< (n)
    type(sparse_type), intent(out) :: matrix
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: by_columns
    if (size(row) /= size(column) .or. size(row) /= size(value)) then
      call set_error(error, EXIT_INTERNAL, 'Triplets of unequal length.')
    else if (any(row < 1) .or. any(row > n_rows) .or. any(column < 1) .or. any(column > n_columns)) then
      call set_error(error, EXIT_INTERNAL, 'A triplet lies outside the matrix.')
    end if
    if (allocated(error)) return
    ! Two stable bucket sorts, by column and then by row, place equal entries next to each other in the order given.
    call bucket_sort(n_columns, n_rows, column, row, value, by_columns)
    matrix = sparse_transpose(by_columns)
    call sum_duplicates(matrix)
  end subroutine sparse_from_triplets


  !> Sorts triplets into rows, stable.
  pure subroutine bucket_sort(n_rows, n_columns, row, column, value, matrix)
    integer, intent(in) :: n_rows, n_columns
    integer, intent(in) :: row(:), column(:)   !< (n)
    real(DP), intent(in) :: value(:)           !< (n)
    type(sparse_type), intent(out) :: matrix   !< columns as they come
    integer :: next(n_rows), k, p
    call allocate_matrix(matrix, n_rows, n_columns, size(row))
    call row_starts(row, n_rows, matrix%first)
    next = matrix%first(:n_rows)
    do k = 1, size(row)
      p = next(row(k))
      next(row(k)) = p + 1
      matrix%column(p) = column(k)
      matrix%value(p) = value(k)
    end do
  end subroutine bucket_sort


  !> Row pointers from the rows of entries: row i has first(i + 1) - first(i) entries.
  pure subroutine row_starts(row, n_rows, first)
    integer, intent(in) :: row(:)              !< row of each entry
    integer, intent(in) :: n_rows
    integer, intent(out) :: first(:)           !< (n_rows + 1)
    integer :: k
    first = 0
    first(1) = 1
    do k = 1, size(row)
      first(row(k) + 1) = first(row(k) + 1) + 1
    end do
    do k = 1, n_rows
      first(k + 1) = first(k) + first(k + 1)
    end do
  end subroutine row_starts


  !> Sums adjacent entries of equal column in a row.
  pure subroutine sum_duplicates(matrix)
    type(sparse_type), intent(inout) :: matrix !< columns ascending, duplicates allowed
    integer :: i, p, n, start
    n = 0
    do i = 1, matrix%n_rows
      start = n
      do p = matrix%first(i), matrix%first(i + 1) - 1
        if (n > start) then
          if (matrix%column(n) == matrix%column(p)) then
            matrix%value(n) = matrix%value(n) + matrix%value(p)
            cycle
          end if
        end if
        n = n + 1
        matrix%column(n) = matrix%column(p)
        matrix%value(n) = matrix%value(p)
      end do
      matrix%first(i) = start + 1
    end do
    matrix%first(matrix%n_rows + 1) = n + 1
    matrix%column = matrix%column(:n)
    matrix%value = matrix%value(:n)
  end subroutine sum_duplicates


  !> Allocates the arrays of a matrix; the values are 0.
  pure subroutine allocate_matrix(matrix, n_rows, n_columns, n_entries)
    type(sparse_type), intent(out) :: matrix
    integer, intent(in) :: n_rows, n_columns, n_entries
    matrix%n_rows = n_rows
    matrix%n_columns = n_columns
    allocate (matrix%first(n_rows + 1), matrix%column(n_entries), matrix%value(n_entries))
    matrix%first = 1
    matrix%value = 0
  end subroutine allocate_matrix


  !> Position of an entry in column(:) and value(:); 0 if it is not in the pattern. Cost: binary search.
  pure function entry_position(matrix, row, column) result(position)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: row
    integer, intent(in) :: column
    integer :: position
    integer :: low, high
    low = matrix%first(row)
    high = matrix%first(row + 1) - 1
    do while (low < high)
      position = low + (high - low) / 2
      if (matrix%column(position) < column) then
        low = position + 1
      else
        high = position
      end if
    end do
    position = 0
    if (low > high) return
    if (matrix%column(low) == column) position = low
  end function entry_position


  !> The transpose. Entries of equal position keep their order. Cost: linear.
  pure function sparse_transpose(matrix) result(transposed)
    type(sparse_type), intent(in) :: matrix
    type(sparse_type) :: transposed
    integer :: next(matrix%n_columns), i, j, p
    call allocate_matrix(transposed, matrix%n_columns, matrix%n_rows, size(matrix%column))
    call row_starts(matrix%column, matrix%n_columns, transposed%first)
    next = transposed%first(:matrix%n_columns)
    do i = 1, matrix%n_rows
      do p = matrix%first(i), matrix%first(i + 1) - 1
        j = matrix%column(p)
        transposed%column(next(j)) = i
        transposed%value(next(j)) = matrix%value(p)
        next(j) = next(j) + 1
      end do
    end do
  end function sparse_transpose


  !> Some rows of a matrix.
  pure function rows_of(matrix, chosen) result(part)
    type(sparse_type), intent(in) :: matrix    !< (n x m)
    integer, intent(in) :: chosen(:)           !< (k) rows, in the order wanted
    type(sparse_type) :: part                  !< (k x m)
    integer :: i, n
    call allocate_matrix(part, size(chosen), matrix%n_columns, sum(matrix%first(chosen + 1) - matrix%first(chosen)))
    part%first(1) = 1
    do i = 1, size(chosen)
      n = matrix%first(chosen(i) + 1) - matrix%first(chosen(i))
      part%first(i + 1) = part%first(i) + n
      part%column(part%first(i):part%first(i + 1) - 1) = matrix%column(matrix%first(chosen(i)):matrix%first(chosen(i) + 1) - 1)
      part%value(part%first(i):part%first(i + 1) - 1) = matrix%value(matrix%first(chosen(i)):matrix%first(chosen(i) + 1) - 1)
    end do
  end function rows_of


  !> The upper triangle of a matrix.
  pure function upper_triangle(matrix) result(upper)
    type(sparse_type), intent(in) :: matrix
    type(sparse_type) :: upper
    integer :: i, p, n
    n = 0
    do i = 1, matrix%n_rows
      n = n + count(matrix%column(matrix%first(i):matrix%first(i + 1) - 1) >= i)
    end do
    call allocate_matrix(upper, matrix%n_rows, matrix%n_columns, n)
    n = 0
    do i = 1, matrix%n_rows
      upper%first(i) = n + 1
      do p = matrix%first(i), matrix%first(i + 1) - 1
        if (matrix%column(p) < i) cycle
        n = n + 1
        upper%column(n) = matrix%column(p)
        upper%value(n) = matrix%value(p)
      end do
    end do
    upper%first(matrix%n_rows + 1) = n + 1
  end function upper_triangle


  !> Both triangles of a symmetric matrix stored by its upper one.
  pure function full_from_upper(matrix) result(full)
    type(sparse_type), intent(in) :: matrix    !< upper triangle
    type(sparse_type) :: full
    type(sparse_type) :: lower
    integer :: i, n, n_below, n_above
    lower = sparse_transpose(matrix)
    call allocate_matrix(full, matrix%n_rows, matrix%n_rows, 2 * size(matrix%column) - matrix%n_rows)
    n = 0
    do i = 1, matrix%n_rows
      full%first(i) = n + 1
      n_below = lower%first(i + 1) - lower%first(i) - 1
      n_above = matrix%first(i + 1) - matrix%first(i)
      full%column(n + 1:n + n_below) = lower%column(lower%first(i):lower%first(i + 1) - 2)
      full%value(n + 1:n + n_below) = lower%value(lower%first(i):lower%first(i + 1) - 2)
      n = n + n_below
      full%column(n + 1:n + n_above) = matrix%column(matrix%first(i):matrix%first(i + 1) - 1)
      full%value(n + 1:n + n_above) = matrix%value(matrix%first(i):matrix%first(i + 1) - 1)
      n = n + n_above
    end do
    full%first(matrix%n_rows + 1) = n + 1
  end function full_from_upper


  !> The product of two matrices, row by row (Gustavson, ACM Trans. Math. Software 4, 1978). Cost: its multiplications.
  pure function sparse_product(left, right) result(matrix)
    type(sparse_type), intent(in) :: left      !< (n x k)
    type(sparse_type), intent(in) :: right     !< (k x m)
    type(sparse_type) :: matrix                !< (n x m)
    integer :: place(right%n_columns)
    integer :: i, p, q, n, start
    call allocate_matrix(matrix, left%n_rows, right%n_columns, n_product_entries(left, right))
    place = 0
    n = 0
    do i = 1, left%n_rows
      start = n
      matrix%first(i) = start + 1
      do p = left%first(i), left%first(i + 1) - 1
        do q = right%first(left%column(p)), right%first(left%column(p) + 1) - 1
          if (place(right%column(q)) <= start) then
            n = n + 1
            place(right%column(q)) = n
            matrix%column(n) = right%column(q)
          end if
          associate (entry => matrix%value(place(right%column(q))))
            entry = entry + left%value(p) * right%value(q)
          end associate
        end do
      end do
    end do
    matrix%first(left%n_rows + 1) = n + 1
    matrix = sparse_transpose(sparse_transpose(matrix))   ! sorts the columns
  end function sparse_product


  !> Entries of a product.
  pure integer function n_product_entries(left, right) result(n)
    type(sparse_type), intent(in) :: left, right
    integer :: seen(right%n_columns), i, p, q
    seen = 0
    n = 0
    do i = 1, left%n_rows
      do p = left%first(i), left%first(i + 1) - 1
        do q = right%first(left%column(p)), right%first(left%column(p) + 1) - 1
          if (seen(right%column(q)) == i) cycle
          seen(right%column(q)) = i
          n = n + 1
        end do
      end do
    end do
  end function n_product_entries


  !> A + factor * B, rows merged in ascending order of the columns.
  pure function sparse_sum(left, factor, right) result(matrix)
    type(sparse_type), intent(in) :: left      !< A (n x m)
    real(DP), intent(in) :: factor
    type(sparse_type), intent(in) :: right     !< B (n x m)
    type(sparse_type) :: matrix                !< (n x m)
    integer :: i, n, p, q, p_end, q_end, a, b
    call allocate_matrix(matrix, left%n_rows, left%n_columns, size(left%column) + size(right%column))
    n = 0
    do i = 1, left%n_rows
      matrix%first(i) = n + 1
      p = left%first(i)
      q = right%first(i)
      p_end = left%first(i + 1)
      q_end = right%first(i + 1)
      do while (p < p_end .or. q < q_end)
        a = left%n_columns + 1
        b = a
        if (p < p_end) a = left%column(p)
        if (q < q_end) b = right%column(q)
        n = n + 1
        matrix%column(n) = min(a, b)
        matrix%value(n) = 0
        if (a <= b) matrix%value(n) = left%value(p)
        if (b <= a) matrix%value(n) = matrix%value(n) + factor * right%value(q)
        if (a <= b) p = p + 1
        if (b <= a) q = q + 1
      end do
    end do
    matrix%first(left%n_rows + 1) = n + 1
    matrix%column = matrix%column(:n)
    matrix%value = matrix%value(:n)
  end function sparse_sum


  !> y = M x. Threads share the rows: bitwise the same for any number of threads.
  subroutine multiply(matrix, x, y)
    type(sparse_type), intent(in) :: matrix    !< (n x m)
    real(DP), intent(in) :: x(:)               !< (m)
    real(DP), intent(out) :: y(:)              !< (n)
    real(DP) :: sum
    integer :: i, p
    !$omp parallel do private(sum, p) schedule(static) if(size(matrix%column) > MIN_THREADED_ENTRIES)
    do i = 1, matrix%n_rows
      sum = 0
      do p = matrix%first(i), matrix%first(i + 1) - 1
        sum = sum + matrix%value(p) * x(matrix%column(p))
      end do
      y(i) = sum
    end do
    !$omp end parallel do
  end subroutine multiply


  !> y = M' x.
  pure subroutine multiply_transpose(matrix, x, y)
    type(sparse_type), intent(in) :: matrix    !< (n x m)
    real(DP), intent(in) :: x(:)               !< (n)
    real(DP), intent(out) :: y(:)              !< (m)
    integer :: i, p
    y = 0
    do i = 1, matrix%n_rows
      do p = matrix%first(i), matrix%first(i + 1) - 1
        y(matrix%column(p)) = y(matrix%column(p)) + matrix%value(p) * x(i)
      end do
    end do
  end subroutine multiply_transpose


  !> y = M x for a symmetric matrix. Each thread adds rows of equal work to its own sum; the sums are added in
  !> the order of the threads: bitwise repeatable for a given number of threads.
  subroutine multiply_symmetric(matrix, x, y)
    type(sparse_type), intent(in) :: matrix    !< upper triangle (n x n)
    real(DP), intent(in) :: x(:)               !< (n)
    real(DP), intent(out) :: y(:)              !< (n)
    real(DP), allocatable :: part(:, :)
    integer :: n_parts, t, i
    integer, allocatable :: start(:)
    n_parts = 1
!$  if (size(matrix%column) > MIN_THREADED_ENTRIES) n_parts = omp_get_max_threads()
    if (n_parts == 1) then
      call multiply_rows(matrix, 1, matrix%n_rows, x, y, 1)
      return
    end if
    start = balance_row_blocks(matrix, n_parts)
    allocate (part(start(2):matrix%n_rows, 2:n_parts))   ! the triangle is upper: rows before start(t) are zero
    !$omp parallel do schedule(static, 1) num_threads(n_parts)
    do t = 1, n_parts
      if (t == 1) then
        call multiply_rows(matrix, start(t), start(t + 1) - 1, x, y, 1)
      else
        call multiply_rows(matrix, start(t), start(t + 1) - 1, x, part(:, t), start(2))
      end if
    end do
    !$omp end parallel do
    !$omp parallel do schedule(static) num_threads(n_parts) private(t)
    do i = start(2), matrix%n_rows
      do t = 2, n_parts
        if (i >= start(t)) y(i) = y(i) + part(i, t)
      end do
    end do
    !$omp end parallel do
  end subroutine multiply_symmetric


  !> Rows with the same columns, often the three of a node, as `n_alike` of a matrix: products and substitutions read the columns of
  !! such rows once. Cost: one pass over the columns.
  pure function alike_rows(matrix) result(n_alike)
    type(sparse_type), intent(in) :: matrix    !< upper triangle with its diagonal
    integer(I8), allocatable :: n_alike(:)     !< (n_rows)
    integer :: i
    allocate (n_alike(matrix%n_rows), source=1_I8)
    i = 1
    do while (i + 2 <= matrix%n_rows)
      if (is_like_next(matrix, i) .and. is_like_next(matrix, i + 1)) then
        n_alike(i:i + 2) = [3_I8, 2_I8, 1_I8]
        i = i + 3
      else
        i = i + 1
      end if
    end do
  end function alike_rows


  !> Whether a row has the columns of the next one behind its diagonal.
  pure logical function is_like_next(matrix, i)
    type(sparse_type), intent(in) :: matrix    !< upper triangle with its diagonal
    integer, intent(in) :: i
    associate (first => matrix%first(i) + 1, next => matrix%first(i + 1), last => matrix%first(i + 2) - 1)
      is_like_next = next - first == last - next + 1
      if (is_like_next) is_like_next = all(matrix%column(first:next - 1) == matrix%column(next:last))
    end associate
  end function is_like_next


  !> Contribution of a range of rows of an upper triangle to the product. Sets y(low:), leaves the rest unchanged.
  pure subroutine multiply_rows(matrix, low, high, x, y, first)
    type(sparse_type), intent(in) :: matrix    !< upper triangle
    integer, intent(in) :: low, high           !< rows
    real(DP), intent(in) :: x(:)
    integer, intent(in) :: first               !< least row of y
    real(DP), intent(inout) :: y(first:)       !< only y(low:) is set
    real(DP) :: sum
    integer :: i, p
    y(low:) = 0
    if (allocated(matrix%n_alike)) then
      call multiply_alike_rows(matrix, low, high, x, y, first)
      return
    end if
    do i = low, high
      p = matrix%first(i)
      sum = matrix%value(p) * x(i)
      do p = matrix%first(i) + 1, matrix%first(i + 1) - 1
        sum = sum + matrix%value(p) * x(matrix%column(p))
        y(matrix%column(p)) = y(matrix%column(p)) + matrix%value(p) * x(i)
      end do
      y(i) = y(i) + sum
    end do
  end subroutine multiply_rows


  !> The same with three rows at a time where they have the same columns: a third of the indices and of the additions to y.
  pure subroutine multiply_alike_rows(matrix, low, high, x, y, first)
    type(sparse_type), intent(in) :: matrix    !< upper triangle, with n_alike
    integer, intent(in) :: low, high           !< rows; no three alike rows are divided
    real(DP), intent(in) :: x(:)
    integer, intent(in) :: first               !< least row of y
    real(DP), intent(inout) :: y(first:)
    real(DP) :: own(3), a, b, c
    integer :: i, j, k, p, q, r
    i = low
    do while (i <= high)
      p = matrix%first(i)
      if (matrix%n_alike(i) == 1_I8) then
        a = matrix%value(p) * x(i)
        do p = matrix%first(i) + 1, matrix%first(i + 1) - 1
          a = a + matrix%value(p) * x(matrix%column(p))
          y(matrix%column(p)) = y(matrix%column(p)) + matrix%value(p) * x(i)
        end do
        y(i) = y(i) + a
        i = i + 1
        cycle
      end if
      q = matrix%first(i + 1)
      r = matrix%first(i + 2)
      own = x(i:i + 2)
      associate (value => matrix%value)
        a = value(p) * own(1) + value(p + 1) * own(2) + value(p + 2) * own(3)
        b = value(p + 1) * own(1) + value(q) * own(2) + value(q + 1) * own(3)
        c = value(p + 2) * own(1) + value(q + 1) * own(2) + value(r) * own(3)
        do k = 1, matrix%first(i + 3) - 1 - r
          j = matrix%column(r + k)
          a = a + value(p + 2 + k) * x(j)
          b = b + value(q + 1 + k) * x(j)
          c = c + value(r + k) * x(j)
          y(j) = y(j) + value(p + 2 + k) * own(1) + value(q + 1 + k) * own(2) + value(r + k) * own(3)
        end do
      end associate
      y(i:i + 2) = y(i:i + 2) + [a, b, c]
      i = i + 3
    end do
  end subroutine multiply_alike_rows


  !> First rows of parts with about equal numbers of entries; alike rows are of one part.
  pure function balance_row_blocks(matrix, n_parts) result(start)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: n_parts
    integer :: start(n_parts + 1)
    integer :: i, t
    i = 1
    do t = 1, n_parts
      start(t) = i
      do while (i <= matrix%n_rows)
        if (matrix%first(i) - 1 >= size(matrix%column) / n_parts * t) exit
        i = i + 1
      end do
    end do
    start(n_parts + 1) = matrix%n_rows + 1
    if (.not. allocated(matrix%n_alike)) return
    do t = 2, n_parts
      if (start(t) <= matrix%n_rows) start(t) = first_alike_row(matrix, start(t))
    end do
  end function balance_row_blocks


  !> The first of the rows alike to a row.
  pure integer function first_alike_row(matrix, row) result(first)
    type(sparse_type), intent(in) :: matrix    !< with n_alike
    integer, intent(in) :: row
    first = row
    do while (first > 1)
      if (matrix%n_alike(first - 1) == 1_I8) exit
      first = first - 1
    end do
  end function first_alike_row


  !> Whether two matrices have the same pattern.
  pure logical function is_same_pattern(a, b) result(is_same)
    type(sparse_type), intent(in) :: a, b
    is_same = .false.
    if (.not. allocated(a%first) .or. .not. allocated(b%first)) return
    if (a%n_rows /= b%n_rows .or. a%n_columns /= b%n_columns .or. size(a%column) /= size(b%column)) return
    is_same = all(a%first == b%first)
    if (is_same) is_same = all(a%column == b%column)
  end function is_same_pattern


  !> The error for a matrix with more entries than default integers can count.
  subroutine set_too_large(error)
    type(error_type), allocatable, intent(out) :: error
    call set_error(error, EXIT_SOLVER, 'The matrix would have more than 2 147 483 647 entries: too large.')
  end subroutine set_too_large

end module amontons_sparse
