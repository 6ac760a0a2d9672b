!> The matrix of a rank's domain from the parts of the matrix that the ranks have summed over their own elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A = sum over the ranks of A_r, each in the numbering of A. A rank needs A between the unknowns of its domain: its own and the
!! halo (`halo`). It adds the entries of its A_r and those that other ranks send: entries whose elements lie on both sides of a
!! border. Entries are added rank by rank, so that the sum has the same bits in every run.
!! Reference: Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, sec. 14.1 (subdomain matrices before assembly).
module amontons_domain_matrix
  use amontons_kinds, only: DP
  use amontons_containers, only: list_groups, sort_ascending
  use amontons_sparse, only: sparse_type
  use amontons_halo, only: halo_list_type, list_domain
  use amontons_mpi_ranks, only: this_rank, n_ranks, sum_over_ranks, exchange_with_ranks
  implicit none
  private
  public :: domain_sum_type, plan_domain_sum, sum_domain

  !> Plan of the sum. Contributions come rank by rank, this one in its turn.
  type :: domain_sum_type
    integer, allocatable :: neighbour(:)           !< (m) ranks with which entries are exchanged, from 0, ascending
    integer, allocatable :: send_first(:)          !< (m + 1) first place of a neighbour in `send`
    integer, allocatable :: send(:)                !< entries of this part that others need
    integer, allocatable :: keep(:)                !< entries of this part in the own domain
    integer, allocatable :: receive_first(:)       !< (m + 1) first place of a neighbour in what is received
    integer :: n_before = 0                        !< contributions of lower ranks
    integer, allocatable :: target(:)              !< entry of the domain's matrix to which each contribution is added
  end type domain_sum_type

  !> Entries of a part in one domain: place in the part, row and column in the domain.
  type :: entry_list_type
    integer, allocatable :: source(:), row(:), column(:)
  end type entry_list_type

contains

  !> Plans the sum and finds the pattern of the domain's matrix; all ranks call it. Cost: linear in the entries.
  subroutine plan_domain_sum(self, part, is_held, owner, halos, matrix)
    type(domain_sum_type), intent(out) :: self
    type(sparse_type), intent(in) :: part          !< A_r, upper triangle
    logical, intent(in) :: is_held(:)              !< (n) an element of this rank contributes to the unknown
    integer, intent(in) :: owner(:)                !< (n) rank of each unknown, from 0
    type(halo_list_type), intent(in) :: halos
    type(sparse_type), intent(out) :: matrix       !< A on the domain, upper triangle, without values
    type(entry_list_type) :: list
    integer, allocatable :: place(:), send(:), n_sent(:), own_row(:), own_column(:), row(:), column(:)
    real(DP), allocatable :: rows(:), columns(:)
    logical, allocatable :: is_listed(:)           ! the diagonal of the own domain is listed in any case
    integer :: r, rank
    rank = this_rank()
    allocate (place(part%n_rows), source=0)
    allocate (n_sent(0:n_ranks() - 1), source=0)
    allocate (send(0), rows(0), columns(0))
    do r = 0, n_ranks() - 1
      is_listed = is_held .or. r == rank
      call list_entries(part, is_listed, list_domain(halos, owner, r), place, list)
      if (r == rank) then
        call move_alloc(list%source, self%keep)
        call move_alloc(list%row, own_row)
        call move_alloc(list%column, own_column)
      else
        n_sent(r) = size(list%source)
        send = [send, list%source]
        rows = [rows, real(list%row, DP)]
        columns = [columns, real(list%column, DP)]
      end if
    end do
    call move_alloc(send, self%send)
    call find_neighbours(self, n_sent)
    call join_contributions(self, own_row, rows, row)
    call join_contributions(self, own_column, columns, column)
    call find_pattern(count(owner == rank) + halos%first(rank + 2) - halos%first(rank + 1), row, column, matrix, self%target)
  end subroutine plan_domain_sum


  !> The entries of a part between the unknowns of a domain.
  pure subroutine list_entries(part, is_held, members, place, list)
    type(sparse_type), intent(in) :: part
    logical, intent(in) :: is_held(:)
    integer, intent(in) :: members(:)              !< unknowns of the domain
    integer, intent(inout) :: place(:)             !< (n) 0; the same afterwards
    type(entry_list_type), intent(out) :: list
    integer :: pass, i, j, p, n
    place(members) = [(i, i=1, size(members))]
    do pass = 1, 2
      n = 0
      do i = 1, size(members)
        if (.not. is_held(members(i))) cycle
        do p = part%first(members(i)), part%first(members(i) + 1) - 1
          j = place(part%column(p))
          if (j == 0) cycle
          n = n + 1
          if (pass == 1) cycle
          list%source(n) = p
          list%row(n) = min(i, j)
          list%column(n) = max(i, j)
        end do
      end do
      if (pass == 1) allocate (list%source(n), list%row(n), list%column(n))
    end do
    place(members) = 0
  end subroutine list_entries


  !> The ranks to which entries go or from which they come, and their numbers.
  subroutine find_neighbours(self, n_sent)
    type(domain_sum_type), intent(inout) :: self
    integer, intent(in) :: n_sent(0:)              !< entries for each rank
    real(DP), allocatable :: counts(:, :)          ! from the first to the second
    integer, allocatable :: n_received(:)
    integer :: k, r
    allocate (counts(0:n_ranks() - 1, 0:n_ranks() - 1), source=0.0_DP)
    counts(this_rank(), :) = real(n_sent, DP)
    call sum_over_ranks(counts)
    allocate (n_received(0:n_ranks() - 1))
    n_received = nint(counts(:, this_rank()))
    self%neighbour = pack([(r, r=0, n_ranks() - 1)], n_sent + n_received > 0)
    allocate (self%send_first(size(self%neighbour) + 1), self%receive_first(size(self%neighbour) + 1), source=1)
    do k = 1, size(self%neighbour)
      self%send_first(k + 1) = self%send_first(k) + n_sent(self%neighbour(k))
      self%receive_first(k + 1) = self%receive_first(k) + n_received(self%neighbour(k))
    end do
    self%n_before = sum(n_received(:this_rank() - 1))
  end subroutine find_neighbours


  !> Integers of all contributions, rank by rank.
  subroutine join_contributions(self, own, sent, all_of_them)
    type(domain_sum_type), intent(in) :: self
    integer, allocatable, intent(inout) :: own(:)  !< in: of this rank's entries in its own domain; out: not allocated
    real(DP), intent(in) :: sent(:)                !< of those for other ranks
    integer, allocatable, intent(out) :: all_of_them(:)
    real(DP) :: received(self%receive_first(size(self%receive_first)) - 1)
    call exchange_with_ranks(self%neighbour, self%send_first, sent, self%receive_first, received)
    associate (n => self%n_before, m => size(own))
      allocate (all_of_them(size(received) + m))
      all_of_them(:n) = nint(received(:n))
      all_of_them(n + 1:n + m) = own
      all_of_them(n + m + 1:) = nint(received(n + 1:))
    end associate
    deallocate (own)
  end subroutine join_contributions


  !> The pattern of rows and columns that may occur several times. A row whose contributions follow one another with ascending
  !! columns, as nearly all do, is taken as it stands; the others are gathered and sorted.
  pure subroutine find_pattern(n, row, column, matrix, target)
    integer, intent(in) :: n                       !< unknowns
    integer, intent(in) :: row(:), column(:)
    type(sparse_type), intent(out) :: matrix       !< columns ascending
    integer, allocatable, intent(out) :: target(:) !< entry of the matrix for each of them
    integer, allocatable :: first(:), members(:), group(:)
    integer :: run_first(n), run_length(n)         ! the contributions of a row as it stands; length -1: scattered
    integer :: position(n), i, k, m
    call find_runs(row, column, run_first, run_length)
    allocate (group(size(row)), source=0)
    where (run_length(row) < 0) group = row
    call list_groups(group, n, first, members)
    deallocate (group)
    matrix%n_rows = n
    matrix%n_columns = n
    allocate (matrix%first(n + 1), matrix%column(size(row)), target(size(row)))
    position = 0
    m = 0
    do i = 1, n
      matrix%first(i) = m + 1
      do k = run_first(i), run_first(i) + run_length(i) - 1
        m = m + 1
        matrix%column(m) = column(k)
        target(k) = m
      end do
      if (run_length(i) >= 0) cycle
      do k = first(i), first(i + 1) - 1
        associate (j => column(members(k)))
          if (position(j) > 0) cycle
          m = m + 1
          position(j) = m
          matrix%column(m) = j
        end associate
      end do
      associate (columns => matrix%column(matrix%first(i):m))
        call sort_ascending(columns)
        position(columns) = [(k, k=matrix%first(i), m)]
        target(members(first(i):first(i + 1) - 1)) = position(column(members(first(i):first(i + 1) - 1)))
        position(columns) = 0
      end associate
    end do
    matrix%first(n + 1) = m + 1
    matrix%column = matrix%column(:m)
  end subroutine find_pattern


  !> The contributions of each row, where they follow one another with ascending columns.
  pure subroutine find_runs(row, column, first, length)
    integer, intent(in) :: row(:), column(:)
    integer, intent(out) :: first(:)               !< (n) first contribution of each row
    integer, intent(out) :: length(:)              !< (n) their number; -1: they are scattered or do not ascend
    integer :: k
    first = 1
    length = 0
    do k = 1, size(row)
      associate (i => row(k))
        if (length(i) == 0) then
          first(i) = k
          length(i) = 1
        else if (length(i) > 0) then
          if (first(i) + length(i) == k .and. column(first(i) + length(i) - 1) < column(k)) then
            length(i) = length(i) + 1
          else
            length(i) = -1
          end if
        end if
      end associate
    end do
  end subroutine find_runs


  !> The values of the domain's matrix; all ranks call it.
  subroutine sum_domain(self, part, matrix)
    type(domain_sum_type), intent(in) :: self
    type(sparse_type), intent(in) :: part          !< A_r of the pattern planned
    type(sparse_type), intent(inout) :: matrix     !< A on the domain: its values are set
    real(DP) :: received(self%receive_first(size(self%receive_first)) - 1)
    integer :: k
    call exchange_with_ranks(self%neighbour, self%send_first, part%value(self%send), self%receive_first, received)
    matrix%value = 0
    do k = 1, self%n_before
      matrix%value(self%target(k)) = matrix%value(self%target(k)) + received(k)
    end do
    associate (n => self%n_before, m => size(self%keep))
      do k = 1, m
        matrix%value(self%target(n + k)) = matrix%value(self%target(n + k)) + part%value(self%keep(k))
      end do
      do k = n + 1, size(received)
        matrix%value(self%target(m + k)) = matrix%value(self%target(m + k)) + received(k)
      end do
    end associate
  end subroutine sum_domain

end module amontons_domain_matrix
