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

  !> Plan of the sum. Contributions come rank by rank, this one in its turn. Those of this rank are runs of entries that follow one
  !! another in its part and in the domain's matrix: nearly all are in a few long ones.
  type :: domain_sum_type
    integer, allocatable :: neighbour(:)           !< (m) ranks with which entries are exchanged, from 0, ascending
    integer, allocatable :: send_first(:)          !< (m + 1) first place of a neighbour in `send`
    integer, allocatable :: send(:)                !< entries of this part that others need
    integer, allocatable :: receive_first(:)       !< (m + 1) first place of a neighbour in what is received
    integer, allocatable :: target(:)              !< entry of the domain's matrix for each one that is received
    integer :: n_before = 0                        !< received from lower ranks
    integer :: n_runs = 0                          !< of this rank's entries
    integer, allocatable :: run(:, :)              !< (3, n_runs or more) first entry in the part and in the domain's matrix, number
  end type domain_sum_type

  !> Entries of a part in one domain: place in the part, row and column in the domain.
  type :: entry_list_type
    integer, allocatable :: source(:), row(:), column(:)
  end type entry_list_type

  !> The domain of this rank while its pattern is found.
  type :: domain_rows_type
    integer, allocatable :: member(:)              !< (n) its unknowns
    integer, allocatable :: place(:)               !< of each unknown of A in the domain; 0: outside
    logical, allocatable :: is_listed(:)           !< (n) the part has a row of the unknown
    type(entry_list_type) :: scattered             !< entries received (source 0); those of the part below the diagonal
    integer, allocatable :: first(:), order(:)     !< of the scattered entries of each row
  end type domain_rows_type

contains

  !> Plans the sum and finds the pattern of the domain's matrix; all ranks call it. Cost: linear in the entries.
  subroutine plan_domain_sum(self, part, is_held, owner, halos, matrix)
    type(domain_sum_type), intent(out) :: self
    type(sparse_type), intent(in) :: part          !< A_r, upper triangle
    logical, intent(in) :: is_held(:)              !< (n) an element of this rank contributes to the unknown
    integer, intent(in) :: owner(:)                !< (n) rank of each unknown, from 0
    type(halo_list_type), intent(in) :: halos
    type(sparse_type), intent(out) :: matrix       !< A on the domain, upper triangle, without values
    type(entry_list_type) :: sent
    type(domain_rows_type) :: rows
    integer, allocatable :: n_sent(:)
    integer :: rank
    rank = this_rank()
    allocate (n_sent(0:n_ranks() - 1))
    call list_sent_entries(part, is_held, owner, halos, sent, n_sent)
    call find_neighbours(self, n_sent)
    call receive_integers(self, sent%row, rows%scattered%row)
    call receive_integers(self, sent%column, rows%scattered%column)
    call move_alloc(sent%source, self%send)
    rows%member = list_domain(halos, owner, rank)
    rows%is_listed = is_held(rows%member) .or. owner(rows%member) == rank
    call find_pattern(self, part, rows, matrix)
  end subroutine plan_domain_sum


  !> The entries of this part in the domains of the other ranks.
  subroutine list_sent_entries(part, is_held, owner, halos, sent, n_sent)
    type(sparse_type), intent(in) :: part
    logical, intent(in) :: is_held(:)
    integer, intent(in) :: owner(:)
    type(halo_list_type), intent(in) :: halos
    type(entry_list_type), intent(out) :: sent     !< rank by rank
    integer, intent(out) :: n_sent(0:)             !< for each rank
    type(entry_list_type) :: list
    integer, allocatable :: place(:)
    integer :: r
    allocate (place(part%n_rows), source=0)
    allocate (sent%source(0), sent%row(0), sent%column(0))
    n_sent = 0
    do r = 0, n_ranks() - 1
      if (r == this_rank()) cycle
      call list_entries(part, is_held, list_domain(halos, owner, r), place, list)
      n_sent(r) = size(list%source)
      sent%source = [sent%source, list%source]
      sent%row = [sent%row, list%row]
      sent%column = [sent%column, list%column]
    end do
  end subroutine list_sent_entries


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


  !> Integers of the entries that are received.
  subroutine receive_integers(self, sent, list)
    type(domain_sum_type), intent(in) :: self
    integer, intent(in) :: sent(:)                 !< of those that are sent
    integer, allocatable, intent(out) :: list(:)
    real(DP) :: received(self%receive_first(size(self%receive_first)) - 1)
    call exchange_with_ranks(self%neighbour, self%send_first, real(sent, DP), self%receive_first, received)
    list = nint(received)
  end subroutine receive_integers


  !> The pattern of the domain's matrix, row by row, and the place of each contribution in it.
  pure subroutine find_pattern(self, part, rows, matrix)
    type(domain_sum_type), intent(inout) :: self
    type(sparse_type), intent(in) :: part
    type(domain_rows_type), intent(inout) :: rows  !< in: members, and entries received
    type(sparse_type), intent(out) :: matrix       !< columns ascending
    integer, allocatable :: columns(:), position(:)   ! of a row; entry of the matrix for each of its columns
    integer :: i, k, n, n_columns
    n = size(rows%member)
    allocate (self%target(size(rows%scattered%row)), self%run(3, 0))
    allocate (rows%place(part%n_rows), source=0)
    rows%place(rows%member) = [(i, i=1, n)]
    allocate (rows%scattered%source(size(self%target)), source=0)
    call scatter_lower_entries(part, rows)
    call list_groups(rows%scattered%row, n, rows%first, rows%order)
    allocate (columns(n + size(rows%scattered%row)), position(n))
    matrix%n_rows = n
    matrix%n_columns = n
    allocate (matrix%first(n + 1), source=1)
    do i = 1, n
      call list_columns(part, rows, i, columns, n_columns)
      matrix%first(i + 1) = matrix%first(i) + n_columns
    end do
    allocate (matrix%column(matrix%first(n + 1) - 1))
    do i = 1, n
      call list_columns(part, rows, i, columns, n_columns)
      associate (first => matrix%first(i))
        matrix%column(first:first + n_columns - 1) = columns(:n_columns)
        position(columns(:n_columns)) = [(k, k=first, first + n_columns - 1)]
      end associate
      call place_row(self, part, rows, i, position)
    end do
  end subroutine find_pattern


  !> Adds the entries of the part that lie below the diagonal of the domain's matrix: those of the halo in columns of lower places.
  pure subroutine scatter_lower_entries(part, rows)
    type(sparse_type), intent(in) :: part
    type(domain_rows_type), intent(inout) :: rows
    integer, allocatable :: source(:), row(:), column(:)
    integer :: pass, i, j, p, n
    do pass = 1, 2
      n = 0
      do i = 1, size(rows%member)
        if (.not. rows%is_listed(i)) cycle
        do p = part%first(rows%member(i)), part%first(rows%member(i) + 1) - 1
          j = rows%place(part%column(p))
          if (j == 0 .or. j >= i) cycle
          n = n + 1
          if (pass == 1) cycle
          source(n) = p
          row(n) = j
          column(n) = i
        end do
      end do
      if (pass == 1) allocate (source(n), row(n), column(n))
    end do
    rows%scattered = entry_list_type([rows%scattered%source, source], [rows%scattered%row, row], [rows%scattered%column, column])
  end subroutine scatter_lower_entries


  !> The columns of a row of the domain's matrix, ascending.
  pure subroutine list_columns(part, rows, i, columns, n)
    type(sparse_type), intent(in) :: part
    type(domain_rows_type), intent(in) :: rows
    integer, intent(in) :: i                       !< row
    integer, intent(inout) :: columns(:)           !< the first n are set
    integer, intent(out) :: n
    logical :: is_ascending
    integer :: j, k, p
    n = 0
    is_ascending = rows%first(i) == rows%first(i + 1)
    if (rows%is_listed(i)) then
      do p = part%first(rows%member(i)), part%first(rows%member(i) + 1) - 1
        j = rows%place(part%column(p))
        if (j < i) cycle
        n = n + 1
        columns(n) = j
        if (n > 1) is_ascending = is_ascending .and. columns(n - 1) < j
      end do
    end if
    if (is_ascending) return
    do k = rows%first(i), rows%first(i + 1) - 1
      n = n + 1
      columns(n) = rows%scattered%column(rows%order(k))
    end do
    call sort_ascending(columns(:n))
    k = n
    n = min(k, 1)
    do p = 2, k
      if (columns(p) == columns(n)) cycle
      n = n + 1
      columns(n) = columns(p)
    end do
  end subroutine list_columns


  !> Where the contributions to a row go.
  pure subroutine place_row(self, part, rows, i, position)
    type(domain_sum_type), intent(inout) :: self
    type(sparse_type), intent(in) :: part
    type(domain_rows_type), intent(in) :: rows
    integer, intent(in) :: i                       !< row
    integer, intent(in) :: position(:)             !< entry of the domain's matrix for each of its columns
    integer :: k, p
    if (rows%is_listed(i)) then
      do p = part%first(rows%member(i)), part%first(rows%member(i) + 1) - 1
        if (rows%place(part%column(p)) >= i) call append_to_runs(self, p, position(rows%place(part%column(p))))
      end do
    end if
    do k = rows%first(i), rows%first(i + 1) - 1
      associate (e => rows%order(k), scattered => rows%scattered)
        if (scattered%source(e) > 0) then
          call append_to_runs(self, scattered%source(e), position(scattered%column(e)))
        else
          self%target(e) = position(scattered%column(e))
        end if
      end associate
    end do
  end subroutine place_row


  !> Appends an entry of the part to the last run, or begins another one.
  pure subroutine append_to_runs(self, source, target)
    type(domain_sum_type), intent(inout) :: self
    integer, intent(in) :: source, target          !< entry of the part, of the domain's matrix
    integer, allocatable :: longer(:, :)
    if (self%n_runs > 0) then
      associate (last => self%run(:, self%n_runs))
        if (source == last(1) + last(3) .and. target == last(2) + last(3)) then
          last(3) = last(3) + 1
          return
        end if
      end associate
    end if
    if (self%n_runs == size(self%run, 2)) then
      allocate (longer(3, 2 * self%n_runs + 8))
      longer(:, :self%n_runs) = self%run
      call move_alloc(longer, self%run)
    end if
    self%n_runs = self%n_runs + 1
    self%run(:, self%n_runs) = [source, target, 1]
  end subroutine append_to_runs


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
    do k = 1, self%n_runs
      associate (p => self%run(1, k), q => self%run(2, k), n => self%run(3, k))
        matrix%value(q:q + n - 1) = matrix%value(q:q + n - 1) + part%value(p:p + n - 1)
      end associate
    end do
    do k = self%n_before + 1, size(received)
      matrix%value(self%target(k)) = matrix%value(self%target(k)) + received(k)
    end do
  end subroutine sum_domain

end module amontons_domain_matrix
