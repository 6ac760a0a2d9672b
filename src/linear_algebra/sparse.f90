!> Compressed sparse row matrices: assembly from triplets, products, and the reduction C'KC.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A matrix is stored by compressed rows with ascending columns. A symmetric matrix stores its upper triangle by rows
!! (column >= row), diagonal always present; the same arrays are its lower triangle by columns, as CHOLMOD requires.
!! Every sum has a fixed order: results repeat bitwise (for a given number of threads where threads are used).
!! Working arrays and linear-time algorithms after Davis, Direct Methods for Sparse Linear Systems, SIAM 2006, ch. 2.
module amontons_sparse
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER, EXIT_INTERNAL
  use amontons_containers, only: sort_integers
!$ use omp_lib, only: omp_get_max_threads
  implicit none
  private
  public :: sparse_type, reduction_type
  public :: sparse_from_triplets, sparse_transpose, full_from_upper, upper_triangle, sparse_product, sparse_sum
  public :: multiply, multiply_transpose, multiply_symmetric
  public :: analyse_reduction, reduce_matrix, is_same_pattern

  integer, parameter :: MIN_THREADED_ENTRIES = 200000   !< entries below which threads cost more than they save
  integer, parameter :: ROWS_PER_BLOCK = 16384          !< rows of a pattern that a thread lists at a time

  !> A sparse matrix by compressed rows. Row i holds the entries first(i) to first(i + 1) - 1.
  type :: sparse_type
    integer :: n_rows = 0
    integer :: n_columns = 0
    integer, allocatable :: first(:)           !< (n_rows + 1)
    integer, allocatable :: column(:)          !< (nnz) ascending within a row
    real(DP), allocatable :: value(:)          !< (nnz)
    logical :: has_node_blocks = .false.       !< an upper triangle of blocks of 3 x 3: the three rows of a node have the same
                                               !! columns, those of whole nodes
  end type sparse_type

  !> Plan of the summation A = C' K C: built once for a pattern of K and C, used for all values of them.
  !> Most rows of C have at most one entry: their entries of K are added directly to one entry of A.
  type :: reduction_type
    private
    integer :: n_entries_k = 0                 !< of K, to recognise a wrong matrix
    integer :: n_entries_c = 0                 !< of C
    integer, allocatable :: target(:)          !< (nnz of K) entry of A; negative: counts twice; 0: dropped or expanded
    integer, allocatable :: row(:)             !< rows of K that have expanded entries
    integer, allocatable :: row_first(:)       !< (size(row) + 1) start of a row's entries in entry(:)
    integer, allocatable :: entry(:)           !< expanded entries of K
    integer, allocatable :: pair(:)            !< entry of A for each pair of C's entries; negative: counts twice
  end type reduction_type

  !> A list of integers that grows.
  type :: growing_list_type
    integer, allocatable :: items(:)
    integer :: n = 0
    integer :: capacity = 0
    logical :: is_full = .false.               !< an item did not fit: default integers cannot count them
  contains
    procedure :: reserve => reserve_items
    procedure :: append => append_item
    procedure :: to_array => list_to_array
  end type growing_list_type

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
    integer :: n_parts, t
    integer, allocatable :: start(:)
    n_parts = 1
!$  if (size(matrix%column) > MIN_THREADED_ENTRIES) n_parts = omp_get_max_threads()
    if (n_parts == 1) then
      call multiply_rows(matrix, 1, matrix%n_rows, x, y)
      return
    end if
    start = balance_row_blocks(matrix, n_parts)
    if (matrix%has_node_blocks) start = start - mod(start - 1, 3)
    allocate (part(matrix%n_rows, 2:n_parts))
    !$omp parallel do schedule(static, 1) num_threads(n_parts)
    do t = 1, n_parts
      if (t == 1) then
        call multiply_rows(matrix, start(t), start(t + 1) - 1, x, y)
      else
        call multiply_rows(matrix, start(t), start(t + 1) - 1, x, part(:, t))
      end if
    end do
    !$omp end parallel do
    do t = 2, n_parts
      y(start(t):) = y(start(t):) + part(start(t):, t)   ! the triangle is upper: rows before start(t) are zero
    end do
  end subroutine multiply_symmetric


  !> Contribution of a range of rows of an upper triangle to the product. Sets y(low:), leaves the rest unchanged.
  pure subroutine multiply_rows(matrix, low, high, x, y)
    type(sparse_type), intent(in) :: matrix    !< upper triangle
    integer, intent(in) :: low, high           !< rows
    real(DP), intent(in) :: x(:)
    real(DP), intent(inout) :: y(:)            !< only y(low:) is set
    real(DP) :: sum
    integer :: i, p
    y(low:) = 0
    if (matrix%has_node_blocks) then
      do i = low, high, 3
        call multiply_node_rows(matrix, i, x, y)
      end do
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


  !> Contribution of the three rows of a node, by blocks of 3 x 3: a third of the indices and of the additions to y.
  pure subroutine multiply_node_rows(matrix, i, x, y)
    type(sparse_type), intent(in) :: matrix    !< upper triangle
    integer, intent(in) :: i                   !< first row
    real(DP), intent(in) :: x(:)
    real(DP), intent(inout) :: y(:)
    real(DP) :: own(3), sum(3), other(3)
    integer :: n, k, j, p, q, r
    n = matrix%first(i + 1) - matrix%first(i) - 3   ! columns of other nodes
    p = matrix%first(i) + 2                    ! before these columns, in each of the rows
    q = p + n + 2
    r = q + n + 1
    own = x(i:i + 2)
    associate (value => matrix%value)
      sum(1) = value(p - 2) * own(1) + value(p - 1) * own(2) + value(p) * own(3)
      sum(2) = value(p - 1) * own(1) + value(q - 1) * own(2) + value(q) * own(3)
      sum(3) = value(p) * own(1) + value(q) * own(2) + value(r) * own(3)
      do k = 1, n, 3
        j = matrix%column(p + k)
        other = x(j:j + 2)
        sum(1) = sum(1) + value(p + k) * other(1) + value(p + k + 1) * other(2) + value(p + k + 2) * other(3)
        sum(2) = sum(2) + value(q + k) * other(1) + value(q + k + 1) * other(2) + value(q + k + 2) * other(3)
        sum(3) = sum(3) + value(r + k) * other(1) + value(r + k + 1) * other(2) + value(r + k + 2) * other(3)
        y(j:j + 2) = y(j:j + 2) + value(p + k:p + k + 2) * own(1) + value(q + k:q + k + 2) * own(2) + &
          value(r + k:r + k + 2) * own(3)
      end do
    end associate
    y(i:i + 2) = y(i:i + 2) + sum
  end subroutine multiply_node_rows


  !> First rows of parts with about equal numbers of entries.
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
  end function balance_row_blocks


  !> Prepares A = C' K C: the pattern of A and the target of every product. C has a row for each unknown of K: empty for a
  !> fixed one, one entry for a free one, several for a dependent one. Entries of C may be zero: they stay in the pattern of A.
  !> Cost: a few passes over K and A.
  subroutine analyse_reduction(matrix, transformation, reduction, reduced, error)
    type(sparse_type), intent(in) :: matrix    !< K, upper triangle (n x n)
    type(sparse_type), intent(in) :: transformation  !< C (n x m)
    type(reduction_type), intent(out) :: reduction
    type(sparse_type), intent(out) :: reduced  !< A, upper triangle (m x m), diagonal present, values 0
    type(error_type), allocatable, intent(out) :: error
    if (matrix%n_rows /= transformation%n_rows .or. matrix%n_columns /= matrix%n_rows) then
      call set_error(error, EXIT_INTERNAL, 'Matrix and relation of a reduction do not fit together.')
      return
    end if
    call reduced_pattern(matrix, transformation, reduced, error)
    if (allocated(error)) return
    reduction%n_entries_k = size(matrix%column)
    reduction%n_entries_c = size(transformation%column)
    call find_single_targets(matrix, transformation, reduced, reduction)
    call find_pair_targets(matrix, transformation, reduced, reduction, error)
  end subroutine analyse_reduction


  !> The pattern of C' K C: row a of A has the columns of row j of C for all j coupled by K with an i that depends on a. The threads
  !! share blocks of rows.
  subroutine reduced_pattern(matrix, transformation, reduced, error)
    type(sparse_type), intent(in) :: matrix, transformation
    type(sparse_type), intent(out) :: reduced
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: dependents, mirrored
    type(growing_list_type), allocatable :: blocks(:)   ! columns of A in a block of rows
    integer :: a, k, n
    mirrored = mirror_entries(matrix, transformation)
    dependents = sparse_transpose(transformation)
    n = transformation%n_columns
    reduced%n_rows = n
    reduced%n_columns = n
    allocate (reduced%first(n + 1), blocks((n + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK))
    !$omp parallel
    call list_columns(matrix, mirrored, dependents, transformation, reduced%first, blocks)
    !$omp end parallel
    if (any(blocks%is_full) .or. sum(int(blocks%n, I64)) >= int(huge(n), I64)) then
      call set_too_large(error)
      return
    end if
    reduced%first(1) = 1
    do a = 1, n
      reduced%first(a + 1) = reduced%first(a) + reduced%first(a + 1)
    end do
    allocate (reduced%column(reduced%first(n + 1) - 1), reduced%value(reduced%first(n + 1) - 1))
    !$omp parallel do schedule(static) private(a)
    do k = 1, size(blocks)
      a = reduced%first((k - 1) * ROWS_PER_BLOCK + 1)
      reduced%column(a:a + blocks(k)%n - 1) = blocks(k)%items(:blocks(k)%n)
      reduced%value(a:a + blocks(k)%n - 1) = 0.0_DP
      deallocate (blocks(k)%items)
    end do
    !$omp end parallel do
  end subroutine reduced_pattern


  !> One thread's share of the blocks. (A procedure: gfortran 12 frees no allocatable variable of a block within a parallel region.)
  subroutine list_columns(matrix, mirrored, dependents, transformation, n_entries, blocks)
    type(sparse_type), intent(in) :: matrix         !< K
    type(sparse_type), intent(in) :: mirrored       !< its transposed entries
    type(sparse_type), intent(in) :: dependents     !< C'
    type(sparse_type), intent(in) :: transformation !< C
    integer, intent(inout) :: n_entries(:)          !< (n_columns + 1) entries of row a of A behind a; the first is not set
    type(growing_list_type), intent(inout) :: blocks(:)
    integer, allocatable :: seen(:)
    integer :: k, a, d, last, n_before
    allocate (seen(transformation%n_columns), source=0)
    !$omp do schedule(dynamic)
    do k = 1, size(blocks)
      last = min(k * ROWS_PER_BLOCK, transformation%n_columns)
      call blocks(k)%reserve(size(matrix%column) / size(blocks) + ROWS_PER_BLOCK)
      do a = (k - 1) * ROWS_PER_BLOCK + 1, last
        n_before = blocks(k)%n
        seen(a) = a
        call blocks(k)%append(a)
        do d = dependents%first(a), dependents%first(a + 1) - 1
          call append_columns_above(matrix, dependents%column(d), transformation, a, seen, blocks(k))
          call append_columns_above(mirrored, dependents%column(d), transformation, a, seen, blocks(k))
        end do
        n_entries(a + 1) = blocks(k)%n - n_before
        call sort_integers(blocks(k)%items(n_before + 1:blocks(k)%n))
      end do
    end do
    !$omp end do
  end subroutine list_columns


  !> The transposed entries of K that the upper triangle of A needs: those that touch an unknown which is not direct. The columns of
  !! direct unknowns ascend with them, so that entries of K between two of them lie in the upper triangle of A already.
  pure function mirror_entries(matrix, transformation) result(mirrored)
    type(sparse_type), intent(in) :: matrix    !< K, upper triangle
    type(sparse_type), intent(in) :: transformation   !< C
    type(sparse_type) :: mirrored              !< pattern only
    logical :: is_direct(matrix%n_rows)        ! one column of C, which no unknown before has
    integer :: next(matrix%n_rows), last, i, j, p
    last = 0
    do i = 1, matrix%n_rows
      is_direct(i) = width(i) == 1
      if (is_direct(i)) is_direct(i) = transformation%column(transformation%first(i)) > last
      if (is_direct(i)) last = transformation%column(transformation%first(i))
    end do
    mirrored%n_rows = matrix%n_rows
    mirrored%n_columns = matrix%n_rows
    next = 0
    do i = 1, matrix%n_rows
      do p = matrix%first(i) + 1, matrix%first(i + 1) - 1
        if (is_needed(i, matrix%column(p))) next(matrix%column(p)) = next(matrix%column(p)) + 1
      end do
    end do
    allocate (mirrored%first(matrix%n_rows + 1))
    mirrored%first(1) = 1
    do j = 1, matrix%n_rows
      mirrored%first(j + 1) = mirrored%first(j) + next(j)
    end do
    next = mirrored%first(:matrix%n_rows)
    allocate (mirrored%column(mirrored%first(matrix%n_rows + 1) - 1))
    do i = 1, matrix%n_rows
      do p = matrix%first(i) + 1, matrix%first(i + 1) - 1
        j = matrix%column(p)
        if (.not. is_needed(i, j)) cycle
        mirrored%column(next(j)) = i
        next(j) = next(j) + 1
      end do
    end do

  contains

    !> Whether the transposed entry of (i, j) is needed.
    pure logical function is_needed(i, j)
      integer, intent(in) :: i, j
      is_needed = .not. (is_direct(i) .and. is_direct(j))
      if (is_needed) is_needed = width(i) > 0 .and. width(j) > 0
    end function is_needed

    !> Entries of one row of C.
    pure integer function width(row)
      integer, intent(in) :: row
      width = transformation%first(row + 1) - transformation%first(row)
    end function width
  end function mirror_entries


  !> Appends the columns of A above the diagonal to which a row of K leads.
  pure subroutine append_columns_above(matrix, row, transformation, a, seen, above)
    type(sparse_type), intent(in) :: matrix    !< K, or its mirrored entries
    integer, intent(in) :: row
    type(sparse_type), intent(in) :: transformation   !< C
    integer, intent(in) :: a                   !< row of A
    integer, intent(inout) :: seen(:)          !< (n_columns) a for those appended already
    type(growing_list_type), intent(inout) :: above
    integer :: p, q
    do p = matrix%first(row), matrix%first(row + 1) - 1
      do q = transformation%first(matrix%column(p)), transformation%first(matrix%column(p) + 1) - 1
        if (transformation%column(q) <= a) cycle
        if (seen(transformation%column(q)) == a) cycle
        seen(transformation%column(q)) = a
        call above%append(transformation%column(q))
      end do
    end do
  end subroutine append_columns_above


  !> The targets of the entries of K whose row and column have one entry of C each. The threads share the rows.
  subroutine find_single_targets(matrix, transformation, reduced, reduction)
    type(sparse_type), intent(in) :: matrix, transformation, reduced
    type(reduction_type), intent(inout) :: reduction
    integer, allocatable :: only(:)            ! the one column of a row of C, else 0
    only = single_entry_columns(transformation)
    allocate (reduction%target(size(matrix%column)))
    !$omp parallel
    call find_targets_of_rows(matrix, reduced, only, reduction%target)
    !$omp end parallel
  end subroutine find_single_targets


  !> One thread's share of the rows. (A procedure: gfortran 12 frees no allocatable variable of a block within a parallel region.)
  subroutine find_targets_of_rows(matrix, reduced, only, target)
    type(sparse_type), intent(in) :: matrix, reduced
    integer, intent(in) :: only(:)             !< (n_rows) the one column of a row of C, else 0
    integer, intent(inout) :: target(:)        !< (n_entries)
    integer, allocatable :: place(:)           ! position of a column in row a of A
    integer :: i, p, a, b
    allocate (place(reduced%n_columns), source=0)
    !$omp do schedule(static)
    do i = 1, matrix%n_rows
      a = only(i)
      target(matrix%first(i):matrix%first(i + 1) - 1) = 0
      if (a == 0) cycle
      call mark_row(reduced, a, place)
      do p = matrix%first(i), matrix%first(i + 1) - 1
        b = only(matrix%column(p))
        if (b == 0) cycle
        target(p) = find_target(reduced, a, b, place)
        if (a == b .and. matrix%column(p) /= i) target(p) = -target(p)
      end do
    end do
    !$omp end do
  end subroutine find_targets_of_rows


  !> The column of each row that has exactly one entry, else 0.
  pure function single_entry_columns(transformation) result(only)
    type(sparse_type), intent(in) :: transformation
    integer :: only(transformation%n_rows)
    integer :: i
    do i = 1, transformation%n_rows
      only(i) = 0
      if (transformation%first(i + 1) - transformation%first(i) == 1) only(i) = transformation%column(transformation%first(i))
    end do
  end function single_entry_columns


  !> Records the positions of the columns of one row.
  pure subroutine mark_row(matrix, row, place)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: row
    integer, intent(inout) :: place(:)         !< (n_columns) entries of other columns are unchanged
    integer :: p
    do p = matrix%first(row), matrix%first(row + 1) - 1
      place(matrix%column(p)) = p
    end do
  end subroutine mark_row


  !> Position of (a, b) or (b, a) in the upper triangle.
  pure integer function find_target(matrix, a, b, place) result(position)
    type(sparse_type), intent(in) :: matrix    !< upper triangle
    integer, intent(in) :: a, b
    integer, intent(in) :: place(:)            !< as mark_row sets it for row a
    if (b >= a) then
      position = place(b)
    else
      position = entry_position(matrix, b, a)
    end if
  end function find_target


  !> The entries of K that touch a row of C with several entries, and the targets of all their pairs, in the order
  !> row i of K, entry a of row i of C, entry of K, entry b of C.
  subroutine find_pair_targets(matrix, transformation, reduced, reduction, error)
    type(sparse_type), intent(in) :: matrix, transformation, reduced
    type(reduction_type), intent(inout) :: reduction
    type(error_type), allocatable, intent(out) :: error
    integer :: place(transformation%n_columns)
    type(growing_list_type) :: rows, row_first, entries, pairs
    integer :: i, p, a, n_before
    place = 0
    do i = 1, matrix%n_rows
      n_before = entries%n
      do p = matrix%first(i), matrix%first(i + 1) - 1
        if (width(matrix%column(p)) * width(i) > 1) call entries%append(p)
      end do
      if (entries%n == n_before) cycle
      call rows%append(i)
      call row_first%append(n_before + 1)
      do a = transformation%first(i), transformation%first(i + 1) - 1
        call mark_row(reduced, transformation%column(a), place)
        call append_pairs(matrix, transformation, reduced, i, a, entries%items(n_before + 1:entries%n), place, pairs)
      end do
    end do
    call row_first%append(entries%n + 1)
    if (pairs%is_full) then
      call set_too_large(error)
      return
    end if
    call rows%to_array(reduction%row)
    call row_first%to_array(reduction%row_first)
    call entries%to_array(reduction%entry)
    call pairs%to_array(reduction%pair)
  contains

    !> Entries of one row of C.
    pure integer function width(row)
      integer, intent(in) :: row
      width = transformation%first(row + 1) - transformation%first(row)
    end function width
  end subroutine find_pair_targets


  !> The targets of the pairs of one entry of C in row i with all entries of C that some entries of row i of K reach.
  pure subroutine append_pairs(matrix, transformation, reduced, i, a, entries, place, pairs)
    type(sparse_type), intent(in) :: matrix, transformation, reduced
    integer, intent(in) :: i                   !< row of K
    integer, intent(in) :: a                   !< entry of C in its row i
    integer, intent(in) :: entries(:)          !< of row i of K
    integer, intent(in) :: place(:)            !< as mark_row sets it for the row of A of this entry
    type(growing_list_type), intent(inout) :: pairs
    integer :: e, j, b, target
    do e = 1, size(entries)
      j = matrix%column(entries(e))
      do b = merge(a, transformation%first(j), j == i), transformation%first(j + 1) - 1
        target = find_target(reduced, transformation%column(a), transformation%column(b), place)
        if (j /= i .and. transformation%column(a) == transformation%column(b)) target = -target
        call pairs%append(target)
      end do
    end do
  end subroutine append_pairs


  !> Whether two matrices have the same pattern.
  pure logical function is_same_pattern(a, b) result(is_same)
    type(sparse_type), intent(in) :: a, b
    is_same = .false.
    if (.not. allocated(a%first) .or. .not. allocated(b%first)) return
    if (a%n_rows /= b%n_rows .or. a%n_columns /= b%n_columns .or. size(a%column) /= size(b%column)) return
    is_same = all(a%first == b%first)
    if (is_same) is_same = all(a%column == b%column)
  end function is_same_pattern


  !> A = C' K C for new values of K and C in the patterns analysed. Cost: one pass over K and the expanded pairs.
  subroutine reduce_matrix(reduction, matrix, transformation, reduced, error)
    type(reduction_type), intent(in) :: reduction
    type(sparse_type), intent(in) :: matrix    !< K, upper triangle (n x n)
    type(sparse_type), intent(in) :: transformation  !< C (n x m)
    type(sparse_type), intent(inout) :: reduced   !< A from analyse_reduction; its values are overwritten
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: scale(matrix%n_rows), product
    integer :: i, p, q
    if (size(matrix%column) /= reduction%n_entries_k .or. size(transformation%column) /= reduction%n_entries_c) then
      call set_error(error, EXIT_INTERNAL, 'A reduction was used with other patterns than those analysed.')
      return
    end if
    call single_entry_values(transformation, scale)
    if (.not. allocated(reduced%value)) allocate (reduced%value(size(reduced%column)))
    reduced%value = 0
    do i = 1, matrix%n_rows
      if (transformation%first(i + 1) - transformation%first(i) /= 1) cycle
      do p = matrix%first(i), matrix%first(i + 1) - 1
        q = reduction%target(p)
        if (q == 0) cycle
        product = scale(i) * matrix%value(p) * scale(matrix%column(p))
        if (q < 0) product = 2 * product
        reduced%value(abs(q)) = reduced%value(abs(q)) + product
      end do
    end do
    call add_pairs(reduction, matrix, transformation, reduced%value)
  end subroutine reduce_matrix


  !> The value of each row that has exactly one entry, else 0.
  pure subroutine single_entry_values(transformation, scale)
    type(sparse_type), intent(in) :: transformation
    real(DP), intent(out) :: scale(:)          !< (n_rows)
    integer :: i
    do i = 1, transformation%n_rows
      scale(i) = 0
      if (transformation%first(i + 1) - transformation%first(i) == 1) scale(i) = transformation%value(transformation%first(i))
    end do
  end subroutine single_entry_values


  !> Adds the contributions of rows of C with several entries, in the order of find_pair_targets.
  pure subroutine add_pairs(reduction, matrix, transformation, value)
    type(reduction_type), intent(in) :: reduction
    type(sparse_type), intent(in) :: matrix, transformation
    real(DP), intent(inout) :: value(:)        !< of A
    real(DP) :: left, product
    integer :: r, i, j, a, b, e, q, k
    k = 0
    do r = 1, size(reduction%row)
      i = reduction%row(r)
      do a = transformation%first(i), transformation%first(i + 1) - 1
        do e = reduction%row_first(r), reduction%row_first(r + 1) - 1
          j = matrix%column(reduction%entry(e))
          left = transformation%value(a) * matrix%value(reduction%entry(e))
          do b = merge(a, transformation%first(j), j == i), transformation%first(j + 1) - 1
            k = k + 1
            q = reduction%pair(k)
            product = left * transformation%value(b)
            if (q < 0) product = 2 * product
            value(abs(q)) = value(abs(q)) + product
          end do
        end do
      end do
    end do
  end subroutine add_pairs


  !> Adds an item to the list. Cost: amortised constant. A list that cannot grow sets is_full.
  pure subroutine append_item(self, item)
    class(growing_list_type), intent(inout) :: self
    integer, intent(in) :: item
    integer, allocatable :: larger(:)
    if (self%n == self%capacity) then
      self%is_full = self%capacity == huge(self%n)
      if (self%is_full) return
      self%capacity = max(1024, self%capacity + min(self%capacity, huge(self%n) - self%capacity))
      allocate (larger(self%capacity))
      if (self%n > 0) larger(:self%n) = self%items
      call move_alloc(larger, self%items)
    end if
    self%n = self%n + 1
    self%items(self%n) = item
  end subroutine append_item


  !> Memory for a number of items in an empty list: pages that are not used cost nothing.
  pure subroutine reserve_items(self, n)
    class(growing_list_type), intent(inout) :: self
    integer, intent(in) :: n
    allocate (self%items(n))
    self%capacity = n
  end subroutine reserve_items


  !> The list as an array of exact size.
  pure subroutine list_to_array(self, array)
    class(growing_list_type), intent(in) :: self
    integer, allocatable, intent(out) :: array(:)
    allocate (array(self%n))
    if (self%n > 0) array = self%items(:self%n)
  end subroutine list_to_array


  !> The error for a matrix with more entries than default integers can count.
  subroutine set_too_large(error)
    type(error_type), allocatable, intent(out) :: error
    call set_error(error, EXIT_SOLVER, 'The matrix would have more than 2 147 483 647 entries: too large.')
  end subroutine set_too_large

end module amontons_sparse
