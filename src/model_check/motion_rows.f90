!> Rows of equations and contacts on the rigid motions of bodies, as a sparse matrix, and the null space of a cluster of bodies.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_motion_rows
  use amontons_kinds, only: DP
  use amontons_containers, only: integer_list_type
  use amontons_column_singletons, only: find_column_singletons
  use amontons_joined_bodies, only: joined_bodies_type, join_bodies, join_vectors
  use amontons_sparse_null_space, only: find_sparse_null_vectors
  implicit none
  private
  public :: bases_type, rows_type, motion_matrix_type, allocate_rows, end_row, build_matrix, find_scaled_null_space

  !> The motions that the supports of a step leave to each body.
  type :: bases_type
    integer, allocatable :: n(:)                   !< (n_bodies) 0 to 6
    real(DP), allocatable :: motion(:, :, :)       !< (6, 6, n_bodies) the first n are orthonormal: t, r
  end type bases_type

  !> Rows of equations and contacts on the motions of the bodies, one after the other.
  type :: rows_type
    integer :: n = 0
    integer :: n_entries = 0
    integer, allocatable :: first(:)               !< (n + 1) start of a row's entries
    logical, allocatable :: is_open(:)             !< (n) of a contact that is open at the start
    integer, allocatable :: body(:)                !< (n_entries)
    real(DP), allocatable :: value(:, :)           !< (6, n_entries) on the motions of that body's basis
    real(DP), allocatable :: work(:, :)            !< (6, n_bodies) the current row on t and r; 0 between rows
    integer, allocatable :: touched(:)             !< bodies of the current row
    integer :: n_touched = 0
  end type rows_type

  !> The rows on all motions as a sparse matrix, and the motions that one row alone has.
  type :: motion_matrix_type
    integer, allocatable :: first_motion(:)        !< (n_bodies + 1) the motions of a body are numbered on
    integer, allocatable :: first(:)               !< (n_rows + 1)
    integer, allocatable :: column(:)              !< (n_entries) motions
    real(DP), allocatable :: value(:)              !< (n_entries)
    integer, allocatable :: solved_columns(:), solved_rows(:)   !< pairs: the row gives the motion once the others are known
    logical, allocatable :: is_solved_row(:)       !< (n_rows)
    integer, allocatable :: place(:)               !< (n_motions) in the Gram matrix of its cluster; 0: solved
  end type motion_matrix_type

  real(DP), parameter :: MIN_PIVOT_PART = 0.1_DP   !< of the largest value of its row [-]

contains

  !> Allocates the rows.
  subroutine allocate_rows(n_bodies, rows)
    integer, intent(in) :: n_bodies
    type(rows_type), intent(out) :: rows
    allocate (rows%work(6, n_bodies), source=0.0_DP)
    allocate (rows%touched(n_bodies), rows%first(65), rows%is_open(64), rows%body(128), rows%value(6, 128))
    rows%first(1) = 1
  end subroutine allocate_rows


  !> Ends the current row: stores its part on the motions that supports leave free.
  subroutine end_row(bases, is_open, rows)
    type(bases_type), intent(in) :: bases
    logical, intent(in) :: is_open                 !< of a contact that is open at the start
    type(rows_type), intent(inout) :: rows
    real(DP) :: value(6), largest
    integer :: i, b, n_before
    n_before = rows%n_entries
    largest = 0.0_DP
    do i = 1, rows%n_touched
      largest = max(largest, maxval(abs(rows%work(:, rows%touched(i)))))
    end do
    do i = 1, rows%n_touched
      b = rows%touched(i)
      value = 0.0_DP
      value(:bases%n(b)) = matmul(rows%work(:, b), bases%motion(:, :bases%n(b), b))
      rows%work(:, b) = 0.0_DP
      if (norm2(value) <= 1.0e-12_DP * largest .or. bases%n(b) == 0) cycle
      if (rows%n_entries == size(rows%body)) call enlarge_entries(rows)
      rows%n_entries = rows%n_entries + 1
      rows%body(rows%n_entries) = b
      rows%value(:, rows%n_entries) = value
    end do
    rows%n_touched = 0
    if (rows%n_entries == n_before) return
    if (rows%n == size(rows%is_open)) then
      rows%is_open = [rows%is_open, rows%is_open]
      rows%first = [rows%first, rows%first]
    end if
    rows%n = rows%n + 1
    rows%is_open(rows%n) = is_open
    rows%first(rows%n + 1) = rows%n_entries + 1
  end subroutine end_row


  !> Doubles the capacity for entries.
  subroutine enlarge_entries(rows)
    type(rows_type), intent(inout) :: rows
    real(DP), allocatable :: larger(:, :)
    integer :: n
    n = size(rows%body)
    rows%body = [rows%body, rows%body]
    allocate (larger(6, 2 * n))
    larger(:, :n) = rows%value
    call move_alloc(larger, rows%value)
  end subroutine enlarge_entries


  !> The sparse matrix of the rows that count. A node without elements, which three equations give, leaves the Gram matrices here.
  subroutine build_matrix(bases, rows, is_start, matrix)
    type(bases_type), intent(in) :: bases
    type(rows_type), intent(in) :: rows
    logical, intent(in) :: is_start                !< .true.: contacts that are open at the start are empty rows
    type(motion_matrix_type), intent(out) :: matrix
    real(DP), parameter :: ROW_ROUNDING = 1.0e-14_DP   ! of the largest value of a row [-]
    real(DP) :: largest
    integer :: b, r, i, l, n
    allocate (matrix%first_motion(size(bases%n) + 1), matrix%first(rows%n + 1))
    matrix%first_motion(1) = 1
    do b = 1, size(bases%n)
      matrix%first_motion(b + 1) = matrix%first_motion(b) + bases%n(b)
    end do
    allocate (matrix%column(6 * rows%n_entries), matrix%value(6 * rows%n_entries))
    n = 0
    do r = 1, rows%n
      matrix%first(r) = n + 1
      if (is_start .and. rows%is_open(r)) cycle
      largest = maxval(abs(rows%value(:, rows%first(r):rows%first(r + 1) - 1)))
      do i = rows%first(r), rows%first(r + 1) - 1
        do l = 1, bases%n(rows%body(i))
          if (abs(rows%value(l, i)) <= ROW_ROUNDING * largest) cycle
          n = n + 1
          matrix%column(n) = matrix%first_motion(rows%body(i)) + l - 1
          matrix%value(n) = rows%value(l, i)
        end do
      end do
    end do
    matrix%first(rows%n + 1) = n + 1
    call find_column_singletons(matrix%first, matrix%column(:n), matrix%value(:n), MIN_PIVOT_PART, matrix%solved_columns, &
      matrix%solved_rows)
    allocate (matrix%is_solved_row(rows%n), source=.false.)
    matrix%is_solved_row(matrix%solved_rows) = .true.
    allocate (matrix%place(matrix%first_motion(size(bases%n) + 1) - 1), source=1)
    matrix%place(matrix%solved_columns) = 0
  end subroutine build_matrix


  !> Null vectors of the rows of a cluster that are not solved; these have no motion that is solved.
  !! Bodies that follow another one are joined to it first. The motions of each body left are scaled by its strongest one, so that
  !! bodies with few rows count as those with many.
  subroutine find_scaled_null_space(matrix, rows_of, n_left, tolerance, n, vectors)
    type(motion_matrix_type), intent(in) :: matrix   !< `place` is set for the motions of the cluster
    type(integer_list_type), intent(in) :: rows_of !< the rows of the cluster
    integer, intent(in) :: n_left(:)               !< motions of each body of the cluster that are not solved
    real(DP), intent(in) :: tolerance              !< of a pivot of the Gram matrix over the largest [-]
    integer, intent(out) :: n
    real(DP), allocatable, intent(out) :: vectors(:, :)   !< (sum of n_left, n) the largest value of each is 1
    type(joined_bodies_type) :: joined
    integer, allocatable :: first(:), column(:)
    real(DP), allocatable :: value(:), of_roots(:, :), scale(:), scale_of_roots(:)
    integer :: i
    call copy_rows(matrix, rows_of, first, column, value)
    scale = scales_of_bodies(column, value, sums(n_left))
    value = scale(column) * value
    call join_bodies(n_left, first, column, value, joined)
    scale_of_roots = scales_of_bodies(column, value, joined%first_of_root - 1)
    call find_sparse_null_vectors(first, column, scale_of_roots(column) * value, size(scale_of_roots), tolerance, n, of_roots)
    do i = 1, n
      of_roots(:, i) = scale_of_roots * of_roots(:, i)
    end do
    allocate (vectors(size(scale), n))
    call join_vectors(joined, of_roots, vectors)
    do i = 1, n
      vectors(:, i) = scale * vectors(:, i)
      vectors(:, i) = vectors(:, i) / maxval(abs(vectors(:, i)))
    end do
  end subroutine find_scaled_null_space


  !> 0 and the sums of the first numbers.
  pure function sums(n) result(last)
    integer, intent(in) :: n(:)
    integer :: last(0:size(n)), k
    last(0) = 0
    do k = 1, size(n)
      last(k) = last(k - 1) + n(k)
    end do
  end function sums


  !> For each motion 1 over the norm of the strongest one of its body; 1 where a body has no rows.
  pure function scales_of_bodies(column, value, last) result(scale)
    integer, intent(in) :: column(:)               !< (n_entries)
    real(DP), intent(in) :: value(:)               !< (n_entries)
    integer, intent(in) :: last(:)                 !< (0 and the bodies) last column of each
    real(DP) :: scale(last(size(last)))
    real(DP) :: norm(last(size(last)))             ! square of it, by columns
    integer :: i, k
    norm = 0.0_DP
    do i = 1, size(column)
      norm(column(i)) = norm(column(i)) + value(i)**2
    end do
    do k = 1, size(last) - 1
      scale(last(k) + 1:last(k + 1)) = maxval(norm(last(k) + 1:last(k + 1)))
    end do
    where (scale > 0.0_DP)
      scale = 1.0_DP / sqrt(scale)
    else where
      scale = 1.0_DP
    end where
  end function scales_of_bodies


  !> The rows of a cluster as a matrix of its own.
  pure subroutine copy_rows(matrix, rows_of, first, column, value)
    type(motion_matrix_type), intent(in) :: matrix
    type(integer_list_type), intent(in) :: rows_of
    integer, allocatable, intent(out) :: first(:)  !< (n_rows + 1)
    integer, allocatable, intent(out) :: column(:) !< (n_entries) places in the cluster
    real(DP), allocatable, intent(out) :: value(:) !< (n_entries)
    integer :: k
    allocate (first(rows_of%n + 1))
    first(1) = 1
    do k = 1, rows_of%n
      first(k + 1) = first(k) + matrix%first(rows_of%items(k) + 1) - matrix%first(rows_of%items(k))
    end do
    allocate (column(first(rows_of%n + 1) - 1), value(first(rows_of%n + 1) - 1))
    do k = 1, rows_of%n
      associate (a => matrix%first(rows_of%items(k)), b => matrix%first(rows_of%items(k) + 1) - 1)
        column(first(k):first(k + 1) - 1) = matrix%place(matrix%column(a:b))
        value(first(k):first(k + 1) - 1) = matrix%value(a:b)
      end associate
    end do
  end subroutine copy_rows

end module amontons_motion_rows
