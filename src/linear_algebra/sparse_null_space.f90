!> Null space of a sparse matrix: strong pivots of its Gram matrix with few neighbours first, the rest by pivoted dense Cholesky.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_sparse_null_space
  use amontons_kinds, only: DP
  use amontons_containers, only: list_groups, owners_of_entries
  use amontons_null_space, only: find_null_vectors
  implicit none
  private
  public :: find_sparse_null_vectors

  real(DP), parameter :: MIN_STRONG_PIVOT = 0.01_DP   !< the diagonal is at most 1 [-]
  integer, parameter :: MAX_DENSE = 100            !< columns that are always left to the dense matrix

  !> A row of a symmetric matrix without its diagonal.
  type :: off_diagonal_type
    integer :: n = 0
    integer, allocatable :: column(:)              !< the first n are set
    real(DP), allocatable :: value(:)              !< likewise
  end type off_diagonal_type

contains

  !> Null vectors of a sparse matrix A by the Cholesky factor of A'A.
  !!
  !! A column whose pivot is strong and which has few neighbours is taken first, in sweeps with a growing number of neighbours; the
  !! Schur complement of the rest has the same nullity, and its null vectors continue to the columns taken. Weak pivots are left to
  !! the dense matrix with diagonal pivoting, which alone decides on the rank. Cost: that of a sparse factorization, and the
  !! cube of what is left. Reference: A. George, J. W. H. Liu, The evolution of the minimum degree ordering
  !! algorithm, SIAM Review 31 (1989).
  subroutine find_sparse_null_vectors(first, column, value, n_columns, tolerance, n, vectors)
    integer, intent(in) :: first(:)                !< (n_rows + 1) start of each row
    integer, intent(in) :: column(:)               !< (n_entries) in a row each column at most once
    real(DP), intent(in) :: value(:)               !< (n_entries) scaled so that each column has at most the norm 1
    integer, intent(in) :: n_columns
    real(DP), intent(in) :: tolerance              !< of a pivot of the Gram matrix over the largest [-]
    integer, intent(out) :: n                      !< n_columns less the rank
    real(DP), allocatable, intent(out) :: vectors(:, :)   !< (n_columns, n)
    type(off_diagonal_type), allocatable :: gram(:)
    real(DP) :: diagonal(n_columns)
    real(DP), allocatable :: dense(:, :), dense_vectors(:, :)
    integer :: taken(n_columns)                    ! columns in the order in which they are taken
    integer :: n_taken, i, k
    integer, allocatable :: rest(:)
    call build_gram(first, column, value, gram, diagonal)
    call take_strong_pivots(gram, diagonal, taken, n_taken, rest)
    allocate (dense(size(rest), size(rest)), dense_vectors(size(rest), size(rest)))
    call fill_dense(gram, diagonal, rest, dense)
    call find_null_vectors(dense, tolerance, n, dense_vectors)
    allocate (vectors(n_columns, n), source=0.0_DP)
    do i = 1, n
      vectors(rest, i) = dense_vectors(:, i)
      do k = n_taken, 1, -1
        associate (row => gram(taken(k)))
          vectors(taken(k), i) = -dot_product(row%value(:row%n), vectors(row%column(:row%n), i)) / diagonal(taken(k))
        end associate
      end do
    end do
  end subroutine find_sparse_null_vectors


  !> A'A, row by row.
  pure subroutine build_gram(first, column, value, gram, diagonal)
    integer, intent(in) :: first(:)                !< (n_rows + 1)
    integer, intent(in) :: column(:)               !< (n_entries)
    real(DP), intent(in) :: value(:)               !< (n_entries)
    type(off_diagonal_type), allocatable, intent(out) :: gram(:)   !< (n_columns)
    real(DP), intent(out) :: diagonal(:)           !< (n_columns)
    integer, allocatable :: start(:), entry(:)     ! entries by columns, in the order of the rows
    integer :: row_of(size(column))
    integer :: found(size(diagonal)), c, r, i, j, n
    real(DP) :: total(size(diagonal))              ! of the present column; 0 between columns
    logical :: is_found(size(diagonal))
    call list_groups(column, size(diagonal), start, entry)
    row_of = owners_of_entries(first)
    allocate (gram(size(diagonal)))
    total = 0.0_DP
    is_found = .false.
    do c = 1, size(diagonal)
      n = 0
      do i = start(c), start(c + 1) - 1
        r = row_of(entry(i))
        do j = first(r), first(r + 1) - 1
          if (.not. is_found(column(j))) then
            n = n + 1
            found(n) = column(j)
            is_found(column(j)) = .true.
          end if
          total(column(j)) = total(column(j)) + value(entry(i)) * value(j)
        end do
      end do
      diagonal(c) = total(c)
      gram(c)%column = pack(found(:n), found(:n) /= c)
      gram(c)%n = size(gram(c)%column)
      gram(c)%value = total(gram(c)%column)
      total(found(:n)) = 0.0_DP
      is_found(found(:n)) = .false.
    end do
  end subroutine build_gram


  !> Takes columns with strong pivots and few neighbours until the rest is small or has many neighbours.
  pure subroutine take_strong_pivots(gram, diagonal, taken, n_taken, rest)
    type(off_diagonal_type), intent(inout) :: gram(:)   !< of a column taken: its row when it was taken
    real(DP), intent(inout) :: diagonal(:)
    integer, intent(out) :: taken(:)
    integer, intent(out) :: n_taken
    integer, allocatable, intent(out) :: rest(:)
    logical :: is_taken(size(gram))
    integer :: place(size(gram))                   ! work; 0 between columns
    integer :: limit, c, m
    m = size(gram)
    n_taken = 0
    is_taken = .false.
    place = 0
    limit = 0
    do while (m - n_taken > max(MAX_DENSE, limit))
      limit = limit + 1 + limit / 4
      do c = 1, m
        if (is_taken(c) .or. gram(c)%n > limit .or. diagonal(c) < MIN_STRONG_PIVOT) cycle
        if (m - n_taken <= MAX_DENSE) exit
        call take_column(c, gram, diagonal, place)
        is_taken(c) = .true.
        n_taken = n_taken + 1
        taken(n_taken) = c
      end do
    end do
    rest = pack([(c, c=1, m)], .not. is_taken)
  end subroutine take_strong_pivots


  !> Subtracts the product of a column from its neighbours, and removes it from their rows.
  pure subroutine take_column(c, gram, diagonal, place)
    integer, intent(in) :: c
    type(off_diagonal_type), intent(inout) :: gram(:)
    real(DP), intent(inout) :: diagonal(:)
    integer, intent(inout) :: place(:)             !< work, 0 on entry and exit
    real(DP) :: factor(gram(c)%n)                  ! of the Cholesky factor
    integer :: neighbours(gram(c)%n), i, j
    neighbours = gram(c)%column(:gram(c)%n)
    factor = gram(c)%value(:gram(c)%n) / sqrt(diagonal(c))
    do i = 1, size(neighbours)
      associate (row => gram(neighbours(i)))
        do j = 1, row%n
          place(row%column(j)) = j
        end do
        call replace_by_last(row, place(c), place)
        do j = 1, size(neighbours)
          if (j == i) cycle
          if (place(neighbours(j)) == 0) call append(row, neighbours(j), place)
          row%value(place(neighbours(j))) = row%value(place(neighbours(j))) - factor(i) * factor(j)
        end do
        place(row%column(:row%n)) = 0
      end associate
      diagonal(neighbours(i)) = diagonal(neighbours(i)) - factor(i)**2
    end do
  end subroutine take_column


  !> Removes an entry of a row.
  pure subroutine replace_by_last(row, j, place)
    type(off_diagonal_type), intent(inout) :: row
    integer, intent(in) :: j                       !< its place
    integer, intent(inout) :: place(:)             !< of the columns in the row
    place(row%column(row%n)) = j
    place(row%column(j)) = 0
    row%column(j) = row%column(row%n)
    row%value(j) = row%value(row%n)
    row%n = row%n - 1
  end subroutine replace_by_last


  !> Adds a zero to a row.
  pure subroutine append(row, c, place)
    type(off_diagonal_type), intent(inout) :: row
    integer, intent(in) :: c                       !< its column
    integer, intent(inout) :: place(:)             !< of the columns in the row
    if (row%n == size(row%column)) then
      row%column = [row%column, row%column, c]     ! doubles the capacity
      row%value = [row%value, row%value, 0.0_DP]
    end if
    row%n = row%n + 1
    row%column(row%n) = c
    row%value(row%n) = 0.0_DP
    place(c) = row%n
  end subroutine append


  !> The rest as a dense matrix.
  pure subroutine fill_dense(gram, diagonal, rest, dense)
    type(off_diagonal_type), intent(in) :: gram(:)
    real(DP), intent(in) :: diagonal(:)
    integer, intent(in) :: rest(:)                 !< columns
    real(DP), intent(out) :: dense(:, :)           !< (rest, rest)
    integer :: place(size(gram)), i, j
    place(rest) = [(i, i=1, size(rest))]
    dense = 0.0_DP
    do i = 1, size(rest)
      associate (row => gram(rest(i)))
        do j = 1, row%n
          dense(place(row%column(j)), i) = row%value(j)
        end do
      end associate
      dense(i, i) = diagonal(rest(i))
    end do
  end subroutine fill_dense

end module amontons_sparse_null_space
